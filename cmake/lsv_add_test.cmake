find_package(GTest REQUIRED)
pkg_check_modules(kissfft IMPORTED_TARGET kissfft-float)

# What every test includes is parsed once.
# It must be a program, as what shares its headers is.
add_executable(lsv_test_headers ${PROJECT_SOURCE_DIR}/cmake/empty.cpp)
target_link_libraries(lsv_test_headers PRIVATE lsv_flags GTest::gtest)
target_compile_options(lsv_test_headers PRIVATE -pthread $<$<CONFIG:Release>:-O1>)
target_precompile_headers(
  lsv_test_headers
  PRIVATE
  <gtest/gtest.h>
  <cmath>
  <filesystem>
  <functional>
  <optional>
  <random>
  <string>
  <vector>)

# lsv_add_test(name [BOTH_FFTS] SOURCES ... LABELS ... LIBS ... [TIMEOUT s]): one test program, one
# ctest entry per test case. BOTH_FFTS: and the same again, named kissfft.*, with the other FFT.
include(GoogleTest)
function(lsv_add_test name)
  cmake_parse_arguments(arg "BOTH_FFTS" "TIMEOUT" "SOURCES;LABELS;LIBS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  lsv_test_program(${name} ${LSV_FFT} "")
  # The back end in the program itself is found before that in the library.
  if(arg_BOTH_FFTS AND LSV_FFT STREQUAL "fftw" AND kissfft_FOUND AND NOT LSV_SANITIZE)
    list(APPEND arg_SOURCES ${PROJECT_SOURCE_DIR}/correlation/fft_kiss.cpp)
    list(APPEND arg_LIBS PkgConfig::kissfft)
    lsv_test_program(${name}_kissfft kissfft kissfft.)
  endif()
endfunction()

# Of lsv_add_test(), whose arg_... it takes.
macro(lsv_test_program program fft prefix)
  add_executable(${program} ${arg_SOURCES})
  target_link_libraries(${program} PRIVATE lsv_flags ${arg_LIBS} GTest::gtest GTest::gtest_main)
  # What is tested is optimised; the tests themselves are compiled once and run once. Some libraries
  # ask for -pthread, and all that share headers must be compiled alike.
  target_compile_options(${program} PRIVATE -pthread $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${program} PRIVATE LSV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                LSV_FFT_BACKEND="${fft}")
  if(LSV_SANITIZE)
    target_compile_definitions(${program} PRIVATE LSV_SANITIZED)
  endif()
  target_precompile_headers(${program} REUSE_FROM lsv_test_headers)
  gtest_discover_tests(
    ${program}
    TEST_PREFIX "${prefix}"
    DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT})
endmacro()
