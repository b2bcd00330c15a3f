# The four OpenCV modules that lsv uses, and one more for its benchmarks, found one by one: Debian's
# OpenCVConfig.cmake comes only with libopencv-dev, which pulls in 400 MB (VTK, Qt, MPI) that lsv
# never touches.
set(_lsv_opencv_modules core imgproc imgcodecs videoio)
if(LSV_DEV)
  list(APPEND _lsv_opencv_modules video)
endif()
find_path(LSV_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
set(_lsv_opencv_libraries)
foreach(module IN LISTS _lsv_opencv_modules)
  find_library(LSV_OPENCV_${module}_LIBRARY opencv_${module})
  list(APPEND _lsv_opencv_libraries LSV_OPENCV_${module}_LIBRARY)
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LsvOpenCV REQUIRED_VARS LSV_OPENCV_INCLUDE_DIR
                                                          ${_lsv_opencv_libraries})

if(LsvOpenCV_FOUND)
  foreach(module IN LISTS _lsv_opencv_modules)
    if(NOT TARGET lsv_opencv_${module})
      add_library(lsv_opencv_${module} UNKNOWN IMPORTED)
      set_target_properties(
        lsv_opencv_${module} PROPERTIES IMPORTED_LOCATION ${LSV_OPENCV_${module}_LIBRARY}
                                        INTERFACE_INCLUDE_DIRECTORIES ${LSV_OPENCV_INCLUDE_DIR})
      if(NOT module STREQUAL "core")
        target_link_libraries(lsv_opencv_${module} INTERFACE lsv_opencv_core)
      endif()
    endif()
  endforeach()
endif()
