# `cmake --install`, and the package that find_package(vesalius COMPONENTS core io ...) finds afterwards. Components of the
# installation are `program`, `library` and `development`: each is a Debian package (VesaliusPackage.cmake).
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)

set(VESALIUS_INCLUDE_DIR ${CMAKE_INSTALL_INCLUDEDIR}/vesalius-${PROJECT_VERSION_MAJOR})
set(VESALIUS_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/vesalius)

# Libraries that name public headers are components. Bottom to top: a component's uses stand before it.
get_property(VESALIUS_COMPONENTS GLOBAL PROPERTY VESALIUS_COMPONENTS)
list(REMOVE_ITEM VESALIUS_COMPONENTS c_interface)  # stands inside of libvesalius.so, below
set(VESALIUS_USES_LINES)
foreach(component IN LISTS VESALIUS_COMPONENTS)
  get_target_property(uses vesalius_${component} VESALIUS_USES)
  get_target_property(headers vesalius_${component} VESALIUS_PUBLIC_HEADERS)
  list(REMOVE_DUPLICATES uses)
  string(REPLACE ";" " " uses "${uses}")
  string(APPEND VESALIUS_USES_LINES "set(vesalius_${component}_uses ${uses})\n")
  install(TARGETS vesalius_${component} EXPORT vesalius_${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT vesalius_${component} NAMESPACE vesalius:: FILE vesalius-${component}.cmake DESTINATION ${VESALIUS_CMAKE_DIR})
  list(TRANSFORM headers PREPEND ${PROJECT_SOURCE_DIR}/include/vesalius/)
  install(FILES ${headers} DESTINATION ${VESALIUS_INCLUDE_DIR}/vesalius)
endforeach()

# The C library, with all that it needs inside: the component c stands on no other.
if(TARGET vesalius_c)
  list(APPEND VESALIUS_COMPONENTS c)
  string(APPEND VESALIUS_USES_LINES "set(vesalius_c_uses)\n")
  install(TARGETS vesalius_c EXPORT vesalius_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
          NAMELINK_COMPONENT development INCLUDES DESTINATION ${VESALIUS_INCLUDE_DIR})
  install(EXPORT vesalius_c NAMESPACE vesalius:: FILE vesalius-c.cmake DESTINATION ${VESALIUS_CMAKE_DIR})
  install(FILES ${PROJECT_SOURCE_DIR}/include/vesalius/vesalius.h DESTINATION ${VESALIUS_INCLUDE_DIR}/vesalius)
  file(RELATIVE_PATH VESALIUS_PREFIX_FROM_PC ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
  string(REGEX REPLACE "/$" "" VESALIUS_PREFIX_FROM_PC ${VESALIUS_PREFIX_FROM_PC})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/vesalius.pc.in ${PROJECT_BINARY_DIR}/vesalius.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/vesalius.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

# The library for programs of Azure Kinect Body Tracking lies where nobody finds it who does not ask for it, beside Microsoft's.
# Its name has no version of ours, so it is in the program's package, of which there is one at a time.
if(TARGET vesalius_k4abt)
  install(TARGETS vesalius_k4abt LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/vesalius/k4abt COMPONENT program)
  install(FILES ${PROJECT_SOURCE_DIR}/src/k4abt/include/k4abt.h ${PROJECT_SOURCE_DIR}/src/k4abt/include/k4abttypes.h
          DESTINATION ${VESALIUS_INCLUDE_DIR}/k4abt)
endif()
# So does that for programs of NiTE 2.
if(TARGET vesalius_nite2)
  install(TARGETS vesalius_nite2 LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/vesalius/nite2 COMPONENT program)
  install(FILES ${PROJECT_SOURCE_DIR}/src/nite2/include/NiteCAPI.h DESTINATION ${VESALIUS_INCLUDE_DIR}/nite2)
endif()

get_property(VESALIUS_OPTIONAL_PACKAGES GLOBAL PROPERTY VESALIUS_OPTIONAL_PACKAGES)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/vesaliusConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/vesaliusConfig.cmake INSTALL_DESTINATION ${VESALIUS_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vesaliusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vesaliusConfig.cmake ${PROJECT_BINARY_DIR}/vesaliusConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindAGG.cmake ${PROJECT_SOURCE_DIR}/cmake/FindLZF.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindLZ4.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindOpenNI2.cmake ${PROJECT_SOURCE_DIR}/cmake/FindFreenect.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindAvformat.cmake ${PROJECT_SOURCE_DIR}/cmake/FindSpng.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindTurboJpeg.cmake
        DESTINATION ${VESALIUS_CMAKE_DIR})

# What the program and the C library find without being told where (src/io/model/default_model.h).
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
set(VESALIUS_DATA_DIR ${CMAKE_INSTALL_DATADIR}/vesalius)
if(TARGET vesalius OR TARGET vesalius_c OR TARGET vesalius_k4abt OR TARGET vesalius_nite2)
  # All but the tests' own.
  install(FILES ${PROJECT_SOURCE_DIR}/data/models/default.model ${PROJECT_SOURCE_DIR}/data/models/default.forest
                ${PROJECT_SOURCE_DIR}/data/models/small.forest ${PROJECT_SOURCE_DIR}/data/models/README.md
                ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${VESALIUS_DATA_DIR}/models)
endif()
# What else the program reads, what bash asks for commands and flags, and the manual of packages.
if(TARGET vesalius)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/bodies ${PROJECT_SOURCE_DIR}/data/demo DESTINATION ${VESALIUS_DATA_DIR})
  if(VESALIUS_TRAINING)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/training/network DESTINATION ${VESALIUS_DATA_DIR}
            FILES_MATCHING PATTERN "*.py" PATTERN requirements.txt PATTERN tests EXCLUDE PATTERN __pycache__ EXCLUDE)
  endif()
  install(FILES ${PROJECT_SOURCE_DIR}/data/completion.bash RENAME vesalius
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/package/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
  # Notices of what is compiled in, where the packages that it is of can be asked for.
  find_program(DPKG_QUERY dpkg-query)
  find_package(Python3 COMPONENTS Interpreter)
  if(DPKG_QUERY AND Python3_FOUND AND CMAKE_GENERATOR STREQUAL Ninja)
    install(CODE "execute_process(
        COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/package/third_party.py
                \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}/THIRD-PARTY-NOTICES.gz ${CMAKE_MAKE_PROGRAM}
                ${PROJECT_BINARY_DIR} $<TARGET_FILE:vesalius> $<$<TARGET_EXISTS:vesalius_c>:$<TARGET_FILE:vesalius_c>>
                $<$<TARGET_EXISTS:vesalius_k4abt>:$<TARGET_FILE:vesalius_k4abt>>
                $<$<TARGET_EXISTS:vesalius_nite2>:$<TARGET_FILE:vesalius_nite2>>
        RESULT_VARIABLE failed)
      if(failed)
        message(WARNING \"THIRD-PARTY-NOTICES.gz lacks what is named above\")
      endif()")
  endif()
  if(VESALIUS_MANUAL)
    find_program(HELP2MAN help2man REQUIRED)
    set(pages ${PROJECT_BINARY_DIR}/man)
    set(script ${PROJECT_SOURCE_DIR}/cmake/manual.sh)
    add_custom_command(OUTPUT ${pages}/vesalius.1.gz COMMAND bash ${script} $<TARGET_FILE:vesalius> ${pages}
                       DEPENDS vesalius ${script} COMMENT "Writing the manual" VERBATIM)
    add_custom_target(vesalius_manual ALL DEPENDS ${pages}/vesalius.1.gz)
    install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  endif()
endif()
