# OpenCV's own package where it is installed; else its modules one by one: Debian ships the CMake package only with
# libopencv-dev, which brings every module and some gigabytes of their dependencies.
# Defines a target opencv_<component> for each component asked for.
find_package(OpenCV CONFIG QUIET COMPONENTS ${OpenCV_FIND_COMPONENTS})
if(OpenCV_FOUND)
  include(FindPackageHandleStandardArgs)
  find_package_handle_standard_args(OpenCV CONFIG_MODE)
  return()
endif()

find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
# Headers made when the library was built, in a folder of the architecture on Debian.
find_path(OpenCV_GENERATED_DIR opencv2/opencv_modules.hpp PATH_SUFFIXES opencv4
          PATHS /usr/include/${CMAKE_LIBRARY_ARCHITECTURE})
mark_as_advanced(OpenCV_INCLUDE_DIR OpenCV_GENERATED_DIR)
set(required_files OpenCV_INCLUDE_DIR OpenCV_GENERATED_DIR)
foreach(component IN LISTS OpenCV_FIND_COMPONENTS)
  find_library(OpenCV_${component}_LIBRARY opencv_${component})
  mark_as_advanced(OpenCV_${component}_LIBRARY)
  list(APPEND required_files OpenCV_${component}_LIBRARY)
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCV REQUIRED_VARS ${required_files})
if(OpenCV_FOUND)
  foreach(component IN LISTS OpenCV_FIND_COMPONENTS)
    if(NOT TARGET opencv_${component})
      add_library(opencv_${component} UNKNOWN IMPORTED)
      set_target_properties(
        opencv_${component}
        PROPERTIES IMPORTED_LOCATION "${OpenCV_${component}_LIBRARY}"
                   INTERFACE_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIR};${OpenCV_GENERATED_DIR}")
    endif()
  endforeach()
endif()
