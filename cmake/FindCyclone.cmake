# Eclipse Cyclone DDS 0.10: what ROS 2 nodes speak. Defines Cyclone::Cyclone. Its own package asks for a C compiler and its
# compiler of IDL, of which nothing here is used.
find_path(Cyclone_INCLUDE_DIR dds/dds.h)
find_library(Cyclone_LIBRARY ddsc)
mark_as_advanced(Cyclone_INCLUDE_DIR Cyclone_LIBRARY)
set(Cyclone_VERSION)
if(Cyclone_INCLUDE_DIR AND EXISTS ${Cyclone_INCLUDE_DIR}/dds/version.h)
  file(STRINGS ${Cyclone_INCLUDE_DIR}/dds/version.h line REGEX "#define DDS_VERSION \"")
  string(REGEX REPLACE ".*\"([0-9.]+).*" "\\1" Cyclone_VERSION "${line}")
endif()

include(FindPackageHandleStandardArgs)
# How messages are handed over as bytes changed before 0.10 and after it.
find_package_handle_standard_args(Cyclone REQUIRED_VARS Cyclone_LIBRARY Cyclone_INCLUDE_DIR VERSION_VAR Cyclone_VERSION
                                  HANDLE_VERSION_RANGE)
if(Cyclone_FOUND AND NOT TARGET Cyclone::Cyclone)
  add_library(Cyclone::Cyclone UNKNOWN IMPORTED)
  set_target_properties(Cyclone::Cyclone PROPERTIES IMPORTED_LOCATION "${Cyclone_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES
                                                                                           "${Cyclone_INCLUDE_DIR}")
endif()
