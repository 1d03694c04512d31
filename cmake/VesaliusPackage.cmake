# `cpack`: Debian packages and an archive, the same bytes wherever and whenever they are made (docs/packages.md, ./dev release).
# The folder cmake/package has what goes into them besides what is installed.
if(NOT TARGET vesalius OR NOT TARGET vesalius_c)
  return()
endif()

set(VESALIUS_MAINTAINER "vesalius maintainers <maintainers@vesalius.invalid>" CACHE STRING "Who answers for Debian packages")
set(VESALIUS_DEVELOPMENT_PACKAGES "" CACHE STRING "Debian packages that the installed libraries are used with (./dev has them)")

# The time that all files get: the last commit's. Debian's changelog has it in words.
set(epoch "$ENV{SOURCE_DATE_EPOCH}")
if(epoch STREQUAL "")
  execute_process(COMMAND git log -1 --format=%ct WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE epoch
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT epoch MATCHES "^[0-9]+$")
  string(TIMESTAMP epoch "%s" UTC)
endif()
set(before "$ENV{SOURCE_DATE_EPOCH}")
set(ENV{SOURCE_DATE_EPOCH} ${epoch})
string(TIMESTAMP VESALIUS_CHANGELOG_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(ENV{SOURCE_DATE_EPOCH} "${before}")

set(here ${CMAKE_CURRENT_LIST_DIR}/package)
set(VESALIUS_DEBIAN_REVISION 1)
set(VESALIUS_PACKAGE_OF_program vesalius)
set(VESALIUS_PACKAGE_OF_development libvesalius-dev)
get_target_property(soversion vesalius_c SOVERSION)
set(VESALIUS_PACKAGE_OF_library libvesalius${soversion})
set(VESALIUS_PACKAGE_EPOCH ${epoch})
configure_file(${here}/options.cmake.in ${PROJECT_BINARY_DIR}/package/options.cmake @ONLY)
configure_file(${here}/changelog.in ${PROJECT_BINARY_DIR}/package/changelog.Debian @ONLY)

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/package/options.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${here}/debian_files.cmake)
set(CPACK_POST_BUILD_SCRIPTS ${here}/same_archive.cmake)
set(CPACK_PACKAGE_VENDOR "vesalius")
set(CPACK_PACKAGE_CONTACT "${VESALIUS_MAINTAINER}")
string(TOLOWER "${PROJECT_NAME}-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" CPACK_PACKAGE_FILE_NAME)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)

# Who uses the program needs neither headers nor libraries, and what those bring; so there are three packages.
set(CPACK_COMPONENTS_ALL program library)
if(VESALIUS_DEVELOPMENT_PACKAGES)
  list(APPEND CPACK_COMPONENTS_ALL development)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${VESALIUS_DEBIAN_REVISION})
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME ${VESALIUS_PACKAGE_OF_program})
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "bash-completion, xdg-utils")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "finds people in frames of depth cameras
vesalius takes frames with colour and depth (RGB-D) and gives people: body
parts and joints in 3-D, a part label for every pixel and a mask per person.
It follows people over time and shows them on a page in a browser.
.
This package has the program, trained models, body models and six frames
to try it with: vesalius detect /usr/share/vesalius/demo")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${VESALIUS_PACKAGE_OF_library})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS ${VESALIUS_PACKAGE_OF_program})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${here}/triggers)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
    "finds people in frames of depth cameras: C library
vesalius takes frames with colour and depth (RGB-D) and gives people: body
parts and joints in 3-D, a part label for every pixel and a mask per person.
.
This package has the shared library with the interface for C and other
languages. The trained models are in the package vesalius.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME ${VESALIUS_PACKAGE_OF_development})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(same_version "${VESALIUS_PACKAGE_OF_library} (= ${PROJECT_VERSION}-${VESALIUS_DEBIAN_REVISION})")
list(JOIN VESALIUS_DEVELOPMENT_PACKAGES ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
string(PREPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${same_version}, ")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "finds people in frames of depth cameras: development files
vesalius takes frames with colour and depth (RGB-D) and gives people: body
parts and joints in 3-D, a part label for every pixel and a mask per person.
.
This package has headers for C and C++, static libraries and what CMake and
pkg-config ask for. The trained models are in the package vesalius.")
include(CPack)
