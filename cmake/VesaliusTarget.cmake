# Settings that every target of this project shares.
add_library(vesalius_settings INTERFACE)
target_compile_features(vesalius_settings INTERFACE cxx_std_20)
target_compile_options(vesalius_settings INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
# No fused multiply-add: the same bytes from every compiler and processor.
target_compile_options(vesalius_settings INTERFACE -ffp-contract=off)
if(VESALIUS_WERROR)
  target_compile_options(vesalius_settings INTERFACE -Werror)
endif()
if(VESALIUS_SANITIZE)
  target_compile_options(vesalius_settings INTERFACE -fsanitize=${VESALIUS_SANITIZE} -fno-omit-frame-pointer
                                                     -fno-sanitize-recover=all)
  target_link_options(vesalius_settings INTERFACE -fsanitize=${VESALIUS_SANITIZE})
endif()

# vesalius_test(NAME source.cpp... LIBRARIES lib...): one GoogleTest binary, its tests known to ctest.
function(vesalius_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "LIBRARIES" ${ARGN})
  if(NOT VESALIUS_BUILD_TESTS)
    return()
  endif()
  add_executable(${name} ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} vesalius_settings GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE VESALIUS_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT 600)
endfunction()
