find_package(GTest REQUIRED)

# lsv_add_test(name SOURCES ... LABELS ... LIBS ... [TIMEOUT s]): one test program, one ctest entry
# per test case.
include(GoogleTest)
function(lsv_add_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "SOURCES;LABELS;LIBS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE lsv_flags ${arg_LIBS} GTest::gtest GTest::gtest_main)
  # What is tested is optimised; the tests themselves are compiled once and run once.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${name} PRIVATE LSV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(
    ${name}
    DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT})
endfunction()
