# Settings that every target of this project shares.
add_library(vesalius_settings INTERFACE)
target_compile_features(vesalius_settings INTERFACE cxx_std_20)
target_compile_options(vesalius_settings INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
# No fused multiply-add: the same bytes from every compiler and processor.
target_compile_options(vesalius_settings INTERFACE -ffp-contract=off)
if(VESALIUS_WERROR)
  target_compile_options(vesalius_settings INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # Its bug 105651: it warns of std::string's own copying.
  target_compile_options(vesalius_settings INTERFACE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow)
endif()
if(VESALIUS_SANITIZE)
  target_compile_options(vesalius_settings INTERFACE -fsanitize=${VESALIUS_SANITIZE} -fno-omit-frame-pointer
                                                     -fno-sanitize-recover=all)
  target_link_options(vesalius_settings INTERFACE -fsanitize=${VESALIUS_SANITIZE})
endif()

# What tests are compiled with besides, after all else: VESALIUS_TEST_FLAGS.
add_library(vesalius_test_settings INTERFACE)
target_compile_options(vesalius_test_settings INTERFACE ${VESALIUS_TEST_FLAGS})

# vesalius_precompile(TARGET): what most files include is read once, where VESALIUS_PCH asks for it; the header of the core
# serves all libraries. A build without (preset fuzz) shows which includes are missing.
function(vesalius_precompile target)
  if(NOT VESALIUS_PCH)
    return()
  endif()
  if(target STREQUAL vesalius_core)
    target_precompile_headers(
      ${target} PRIVATE <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <optional> <ranges> <sstream>
      <string> <vector> <Eigen/Geometry>)
  else()
    target_precompile_headers(${target} REUSE_FROM vesalius_core)
  endif()
endfunction()

# vesalius_thread_tests(LIST): leaves of the tests' sources those that the thread sanitizer can say something about: the files
# with a test named after threads, and what is no test.
function(vesalius_thread_tests list)
  set(kept)
  foreach(source IN LISTS ${list})
    file(STRINGS ${source} threads REGEX "^TEST.*Thread" LIMIT_COUNT 1)
    if(threads OR NOT source MATCHES "_test.cpp$")
      list(APPEND kept ${source})
    endif()
  endforeach()
  set(${list} ${kept} PARENT_SCOPE)
endfunction()

# vesalius_test(NAME source.cpp... LIBRARIES lib...): one GoogleTest binary, its tests known to ctest.
function(vesalius_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "LIBRARIES" ${ARGN})
  if(NOT VESALIUS_BUILD_TESTS)
    return()
  endif()
  set(sources ${ARG_UNPARSED_ARGUMENTS})
  if(VESALIUS_SANITIZE MATCHES thread)
    vesalius_thread_tests(sources)
    if(NOT sources MATCHES "_test.cpp")
      return()
    endif()
  endif()
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} vesalius_settings GTest::gmock GTest::gtest_main vesalius_test_settings)
  if(VESALIUS_PCH AND NOT name STREQUAL core_test)
    target_precompile_headers(${name} REUSE_FROM core_test)
  elseif(VESALIUS_PCH)
    target_precompile_headers(${name} PRIVATE <algorithm> <cmath> <memory> <string> <vector> <Eigen/Geometry> <gmock/gmock.h>)
  endif()
  # Only files that ask for it learn where the sources are: the others compile alike in every clone.
  foreach(source IN LISTS sources)
    file(STRINGS ${source} asks REGEX VESALIUS_SOURCE_DIR LIMIT_COUNT 1)
    if(asks)
      set_source_files_properties(${source} PROPERTIES COMPILE_DEFINITIONS VESALIUS_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    endif()
  endforeach()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT 600)
endfunction()
