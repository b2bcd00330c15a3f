# Flags that every target of ours shares, and the one way to declare a library.
add_library(lsv_flags INTERFACE)
target_include_directories(lsv_flags SYSTEM INTERFACE)
target_compile_options(
  lsv_flags
  INTERFACE -Wall
            -Wextra
            -Wconversion
            -Wshadow
            # results are the same on every target only while a*b+c is never fused behind our back
            -ffp-contract=off
            $<$<BOOL:${LSV_DEV}>:-Werror>)
if(LSV_SANITIZE)
  target_compile_options(lsv_flags INTERFACE -fsanitize=${LSV_SANITIZE} -fno-sanitize-recover=all
                                             -fno-omit-frame-pointer)
  target_link_options(lsv_flags INTERFACE -fsanitize=${LSV_SANITIZE})
endif()

# lsv_library(name [PARSES] SOURCES ... [PUBLIC targets...] [PRIVATE targets...])
# PARSES: it reads what others wrote, so the fuzzer is to see its branches.
function(lsv_library name)
  cmake_parse_arguments(arg "PARSES" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${arg_SOURCES})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${arg_PUBLIC} PRIVATE lsv_flags ${arg_PRIVATE})
  if(LSV_FUZZ AND arg_PARSES)
    target_compile_options(${name} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()
