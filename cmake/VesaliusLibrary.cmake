# vesalius_library(NAME [FOLDERS folder...] [USES library...] [TESTS_USE library...] [PUBLIC header...] [OPENS_NO_FILES]
#                  [PRECOMPILED])
#
# The library vesalius_NAME out of all sources in FOLDERS (below the current folder; "." is that folder itself, the
# default), and the test NAME_test out of their *_test.cpp. tools/check_layers.py reads these calls: FOLDERS stand bottom to
# top, a file includes only folders up to its own, the core, and the libraries it USES; tests also capsule and TESTS_USE.
# PUBLIC: its headers in include/vesalius, which are installed: `base/image.h` is include/vesalius/image.h and belongs to the
# folder base. A library with some is a component of the installed package.
# PRECOMPILED: with the core's precompiled header, for libraries that it makes quicker to build.
# OPENS_NO_FILES: no <fstream>, <iostream> or <filesystem> outside of tests.
function(vesalius_library name)
  cmake_parse_arguments(ARG "OPENS_NO_FILES;PRECOMPILED" "" "FOLDERS;USES;TESTS_USE;PUBLIC" ${ARGN})
  if(NOT ARG_FOLDERS)
    set(ARG_FOLDERS .)
  endif()
  set(sources)
  set(tests)
  foreach(folder IN LISTS ARG_FOLDERS)
    get_filename_component(place ${folder} ABSOLUTE)
    file(GLOB found CONFIGURE_DEPENDS ${place}/*.cpp)
    foreach(source IN LISTS found)
      if(source MATCHES "_test\\.cpp$")
        list(APPEND tests ${source})
      else()
        list(APPEND sources ${source})
      endif()
    endforeach()
  endforeach()
  list(REMOVE_ITEM sources ${VESALIUS_SOURCES_LEFT_OUT})
  if(VESALIUS_LEFT_OUT)
    list(FILTER sources EXCLUDE REGEX "/src/(${VESALIUS_LEFT_OUT})\\.cpp$")
  endif()

  set(target vesalius_${name})
  add_library(${target} STATIC ${sources})
  add_library(vesalius::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:vesalius_settings>)
  if(ARG_PRECOMPILED)
    vesalius_precompile(${target})
  endif()
  if(NOT name STREQUAL core)
    target_link_libraries(${target} PUBLIC vesalius_core)
  endif()
  # Includes are written from include/ and from the wing's folder: src/, training/ or tests/.
  string(REGEX REPLACE "^${PROJECT_SOURCE_DIR}/([a-z]+)/.*" "\\1" wing ${CMAKE_CURRENT_SOURCE_DIR})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/${wing}>)
  foreach(library IN LISTS ARG_USES)
    target_link_libraries(${target} PUBLIC vesalius_${library})
  endforeach()

  if(ARG_PUBLIC)
    list(TRANSFORM ARG_PUBLIC REPLACE "^.*/" "")
    set_property(GLOBAL APPEND PROPERTY VESALIUS_COMPONENTS ${name})
    set_target_properties(${target} PROPERTIES VESALIUS_USES "core;${ARG_USES}" VESALIUS_PUBLIC_HEADERS "${ARG_PUBLIC}")
  endif()

  if(tests)
    list(TRANSFORM ARG_TESTS_USE PREPEND vesalius_)
    vesalius_test(${name}_test ${tests} LIBRARIES ${target} ${ARG_TESTS_USE} vesalius_capsule)
  endif()
endfunction()

# vesalius_shared(NAME LIBRARY SYMBOLS USES library...): the shared library vesalius_NAME out of the objects of LIBRARY, with the
# libraries that it USES inside. It exports what the version script SYMBOLS names.
function(vesalius_shared name library symbols)
  cmake_parse_arguments(ARG "" "" "USES" ${ARGN})
  set(target vesalius_${name})
  add_library(${target} SHARED $<TARGET_OBJECTS:vesalius_${library}>)
  add_library(vesalius::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX LINK_DEPENDS ${symbols})
  list(TRANSFORM ARG_USES PREPEND vesalius_)
  target_link_libraries(${target} PRIVATE ${ARG_USES} vesalius_core vesalius_settings)
  # Of them only what is called is linked, and of other libraries only those that this needs.
  target_link_options(${target} PRIVATE -Wl,--as-needed -Wl,--gc-sections -Wl,--exclude-libs,ALL
                      -Wl,--version-script=${symbols})
  # Threads of oneTBB run on for a moment after the last call. Hosts that unload libraries, as Mono does at its end, would take
  # their code away from under them.
  target_link_options(${target} PRIVATE -Wl,-z,nodelete)
endfunction()

# vesalius_generate(TARGET TEMPLATE.inc.in [VARIABLE FILE]...): TEMPLATE.inc for TARGET to include, each @VARIABLE@ the text
# of a file below the project's data folder: what a library knows without opening a file.
function(vesalius_generate target template)
  set(arguments ${ARGN})
  while(arguments)
    list(POP_FRONT arguments variable file)
    file(READ ${PROJECT_SOURCE_DIR}/data/${file} ${variable})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/data/${file})
  endwhile()
  get_filename_component(name ${template} NAME)
  string(REGEX REPLACE "\\.in$" "" name ${name})
  configure_file(${template} ${CMAKE_CURRENT_BINARY_DIR}/generated/${name} @ONLY)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
endfunction()

# vesalius_together(LIBRARY [APART SOURCE...]): whoever builds the program once compiles a dozen files together, since the headers
# cost more time than what is in a file (no two files have one name for two things); whoever develops compiles single files.
# APART: files that are compiled for several processors, which include themselves, or are large by themselves.
function(vesalius_together library)
  cmake_parse_arguments(ARG "" "" "APART" ${ARGN})
  if(CMAKE_BUILD_TYPE STREQUAL Release)
    set_target_properties(vesalius_${library} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
    set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      # It takes these files for headers, whose unnamed namespaces it warns of.
      target_compile_options(vesalius_${library} PRIVATE -Wno-subobject-linkage)
    endif()
  endif()
endfunction()

# vesalius_words(LIBRARY): for libraries of words and flags, where nothing is worth the compiler's time, half of which goes into
# the templates of CLI11 and of JSON. Where they are compiled together, the one file reads the headers itself.
function(vesalius_words library)
  target_compile_options(vesalius_${library} PRIVATE -O1)
  get_target_property(together vesalius_${library} UNITY_BUILD)
  if(VESALIUS_PCH AND NOT together)
    target_precompile_headers(vesalius_${library} PRIVATE <CLI/CLI.hpp> <Eigen/Geometry> <algorithm> <filesystem> <functional>
                              <map> <memory> <optional> <ranges> <string> <vector>)
  endif()
endfunction()
