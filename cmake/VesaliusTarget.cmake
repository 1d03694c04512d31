# Settings that every target of this project shares.
add_library(vesalius_settings INTERFACE)
target_compile_features(vesalius_settings INTERFACE cxx_std_20)
# No fused multiply-add: the same bytes from every compiler and processor.
set(vesalius_options -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off)
# Only by the compilers that all changes are tried with (.ci): others warn of other things, which must not end whoever runs the tests.
if(VESALIUS_WERROR AND "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}" MATCHES "^(GNU 12|Clang 14)\\.")
  list(APPEND vesalius_options -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 14)
  # Its bug 105651: it warns of std::string's own copying; what is left of it in 13 too.
  list(APPEND vesalius_options -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_BUILD_TYPE STREQUAL Release)
  # A tenth of the time to compile files together is GCC's collecting of its own garbage; without, it takes a quarter more memory.
  list(APPEND vesalius_options --param=ggc-min-heapsize=1048576)
endif()
if(VESALIUS_SANITIZE)
  list(APPEND vesalius_options -fsanitize=${VESALIUS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    list(APPEND vesalius_options -Wno-maybe-uninitialized -Wno-stringop-overread)  # false ones of instrumented code, as GCC's manual says
  endif()
  target_link_options(vesalius_settings INTERFACE -fsanitize=${VESALIUS_SANITIZE})
endif()
target_compile_options(vesalius_settings INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:${vesalius_options}>")  # nvcc has others

# What tests are compiled with besides, after all else: VESALIUS_TEST_FLAGS.
add_library(vesalius_test_settings INTERFACE)
target_compile_options(vesalius_test_settings INTERFACE ${VESALIUS_TEST_FLAGS})
target_link_libraries(vesalius_test_settings INTERFACE hwy::hwy)  # of kernels; the same in all, which share a precompiled header

# vesalius_precompile(TARGET): what most files include is read once, where VESALIUS_PCH asks for it; the header of the core
# serves all libraries. A build without (.ci/nightly) shows which includes are missing.
function(vesalius_precompile target)
  if(NOT VESALIUS_PCH)
    return()
  endif()
  # A header is shared only among targets with the same definitions, and these packages come with some.
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:hwy::hwy> $<BUILD_INTERFACE:tomlplusplus::tomlplusplus>)
  if(target STREQUAL vesalius_core)
    target_precompile_headers(
      ${target} PRIVATE <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <optional> <ranges> <sstream>
      <string> <vector> <Eigen/Geometry>)
  else()
    target_precompile_headers(${target} REUSE_FROM vesalius_core)
  endif()
endfunction()

add_custom_target(vesalius_tests)  # all programs of tests, and what they run

# Labels that a test can have: a line `// Labels: threads slow` above it gives it to ctest (-L, -LE).
#   threads     compares what several threads do with what one does: what the thread sanitizer runs
#   real        needs the real frames, which are not part of the project
#   statistics  counts over hundreds of bodies, poses or scenes
#   slow        takes more than some seconds
#   gpu         needs a card, and a build with its kernels
set(VESALIUS_TEST_LABELS threads real statistics slow gpu)

# vesalius_thread_tests(LIST): leaves of the tests' sources those with a test labelled `threads`, and what is no test.
function(vesalius_thread_tests list)
  set(kept)
  foreach(source IN LISTS ${list})
    file(STRINGS ${source} threads REGEX "^// Labels:.* threads" LIMIT_COUNT 1)
    if(threads OR NOT source MATCHES "_test.cpp$")
      list(APPEND kept ${source})
    endif()
  endforeach()
  set(${list} ${kept} PARENT_SCOPE)
endfunction()

# vesalius_add_suites(TARGET source.cpp...): a ctest test for each suite of the sources, since starting a process for each test
# takes longer than most tests; those with labels apart: Suite.threads. The target is a label of all its tests.
function(vesalius_add_suites target)
  set(groups)
  foreach(source IN LISTS ARGN)
    file(STRINGS ${source} lines REGEX "^(// Labels:|[A-Z_]*TEST[A-Z_]*\\()")
    set(labels)
    foreach(line IN LISTS lines)
      if(line MATCHES "^// Labels:(.*)")
        string(STRIP "${CMAKE_MATCH_1}" labels)
        string(REPLACE " " ";" labels "${labels}")
        foreach(label IN LISTS labels)
          if(NOT label IN_LIST VESALIUS_TEST_LABELS)
            message(FATAL_ERROR "${source}: label ${label}: expected one of ${VESALIUS_TEST_LABELS}")
          endif()
        endforeach()
      elseif(line MATCHES "^TEST(_F|_P)?\\(([A-Za-z0-9_]+), ([A-Za-z0-9_]+)\\)")
        set(suite ${CMAKE_MATCH_2})
        set(test ${CMAKE_MATCH_2}.${CMAKE_MATCH_3})
        if(CMAKE_MATCH_1 STREQUAL "_P")
          set(test "*/${test}/*")
        endif()
        list(JOIN labels "." group)
        string(REGEX REPLACE "\\.$" "" group "${suite}.${group}")
        list(APPEND groups ${group})
        list(APPEND tests_${group} ${test})
        set(labels_${group} ${labels})
        set(labels)
      elseif(labels OR NOT line MATCHES "^INSTANTIATE_TEST_SUITE_P\\(")
        message(FATAL_ERROR "${source}: expected TEST, TEST_F or TEST_P and both names on a line, found: ${line}")
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES groups)
  foreach(group IN LISTS groups)
    list(JOIN tests_${group} ":" filter)
    add_test(NAME ${group} COMMAND ${target} --gtest_filter=${filter})
    # GoogleTest calls a filter that fits nothing a success.
    set_tests_properties(${group} PROPERTIES TIMEOUT 900 LABELS "${target};${labels_${group}}"
                                             FAIL_REGULAR_EXPRESSION "Running 0 tests")
    if(labels_${group})
      set_tests_properties(${group} PROPERTIES COST 100)  # the longest first, so that none runs alone at the end
    endif()
  endforeach()
endfunction()

# vesalius_test(NAME source.cpp... LIBRARIES lib...): one GoogleTest binary, its suites known to ctest.
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
  add_dependencies(vesalius_tests ${name})
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
      set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS VESALIUS_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    endif()
  endforeach()
  vesalius_add_suites(${name} ${sources})
endfunction()
