# libfreenect: the Kinect v1. Defines Freenect::Freenect.
find_path(Freenect_INCLUDE_DIR libfreenect.h PATH_SUFFIXES libfreenect)
find_library(Freenect_LIBRARY freenect)
mark_as_advanced(Freenect_INCLUDE_DIR Freenect_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Freenect REQUIRED_VARS Freenect_LIBRARY Freenect_INCLUDE_DIR)
if(Freenect_FOUND AND NOT TARGET Freenect::Freenect)
  add_library(Freenect::Freenect UNKNOWN IMPORTED)
  set_target_properties(Freenect::Freenect PROPERTIES IMPORTED_LOCATION "${Freenect_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES
                                                                                              "${Freenect_INCLUDE_DIR}")
endif()
