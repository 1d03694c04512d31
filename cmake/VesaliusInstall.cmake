# `cmake --install`, and the package that find_package(vesalius COMPONENTS core io draw) finds afterwards.
include(CMakePackageConfigHelpers)

set(VESALIUS_INCLUDE_DIR ${CMAKE_INSTALL_INCLUDEDIR}/vesalius-${PROJECT_VERSION_MAJOR})
set(VESALIUS_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/vesalius)

# Headers for users. The core's include each other, so all of them; of a satellite only what it is meant for.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/vesalius DESTINATION ${VESALIUS_INCLUDE_DIR} FILES_MATCHING PATTERN "*.h"
        PATTERN "*_inl.h" EXCLUDE PATTERN "for_each_target.h" EXCLUDE)
set(VESALIUS_io_HEADERS atomic_file camera_file image_file model_file open_source options_file pcd ply video write_frames)
set(VESALIUS_draw_HEADERS draw)

foreach(component core io draw)
  if(NOT TARGET vesalius_${component})
    continue()
  endif()
  install(TARGETS vesalius_${component} EXPORT vesalius_${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT vesalius_${component} NAMESPACE vesalius:: FILE vesalius-${component}.cmake
          DESTINATION ${VESALIUS_CMAKE_DIR})
  foreach(header IN LISTS VESALIUS_${component}_HEADERS)
    install(FILES ${PROJECT_SOURCE_DIR}/src/${component}/${header}.h DESTINATION ${VESALIUS_INCLUDE_DIR}/${component})
  endforeach()
endforeach()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/vesaliusConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/vesaliusConfig.cmake INSTALL_DESTINATION ${VESALIUS_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/vesaliusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vesaliusConfig.cmake ${PROJECT_BINARY_DIR}/vesaliusConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindOpenCV.cmake ${PROJECT_SOURCE_DIR}/cmake/FindLZF.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindHDF5C.cmake
        DESTINATION ${VESALIUS_CMAKE_DIR})

# What the program finds without being told where (src/cli/default_model.h), and what bash asks for commands and flags.
if(TARGET vesalius)
  set(VESALIUS_DATA_DIR ${CMAKE_INSTALL_DATADIR}/vesalius)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/models DESTINATION ${VESALIUS_DATA_DIR} FILES_MATCHING
          PATTERN "*.forest" PATTERN "README.md")
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${VESALIUS_DATA_DIR}/models)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/bodies DESTINATION ${VESALIUS_DATA_DIR})
  install(FILES ${PROJECT_SOURCE_DIR}/data/completion.bash RENAME vesalius
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
endif()
