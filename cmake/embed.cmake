# lsv_embed(<output.cpp> <header> <namespace> ASSET <constant> <file>... [ASSET ...]): writes a C++
# source that defines each constant, declared as std::string_view in the header, as the contents of
# its files one after another. Editing a file makes the next build write the source again.
function(lsv_embed output header namespace)
  set(source "// Written by cmake/embed.cmake.\n#include \"${header}\"\n\nnamespace ${namespace} {\n")
  set(literal_end "")
  while(ARGN)
    list(POP_FRONT ARGN word)
    if(word STREQUAL "ASSET")
      list(POP_FRONT ARGN constant)
      string(APPEND source "${literal_end}const std::string_view ${constant} =")
      set(literal_end ";\n")
    else()
      file(READ "${word}" contents)
      string(APPEND source "\n    R\"lsv_asset(${contents})lsv_asset\"")
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${word}")
    endif()
  endwhile()
  string(APPEND source "${literal_end}}  // namespace ${namespace}\n")

  set(written "")
  if(EXISTS "${output}")
    file(READ "${output}" written)
  endif()
  # An untouched file is not compiled again.
  if(NOT written STREQUAL source)
    file(WRITE "${output}" "${source}")
  endif()
endfunction()
