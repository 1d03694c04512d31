# Run by cpack before it packs: what Debian expects in a package, and only there.
if(NOT CPACK_GENERATOR STREQUAL "DEB")
  return()
endif()

function(compress source target)
  execute_process(COMMAND gzip -9n INPUT_FILE ${source} OUTPUT_FILE ${target} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(package ${VESALIUS_PACKAGE_OF_${component}})
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr)
  set(doc ${root}/share/doc/${package})
  file(MAKE_DIRECTORY ${doc})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/copyright ${doc}/copyright COPYONLY)
  if(NOT component STREQUAL "program")  # which has the notices of all
    file(COPY ${CPACK_TEMPORARY_DIRECTORY}/program/usr/share/doc/${VESALIUS_PACKAGE_OF_program}/THIRD-PARTY-NOTICES.gz DESTINATION ${doc})
  endif()
  compress(${VESALIUS_PACKAGE_DIR}/changelog.Debian ${doc}/changelog.Debian.gz)
  compress(${VESALIUS_SOURCE_DIR}/CHANGELOG.md ${doc}/changelog.gz)
  if(EXISTS ${CMAKE_CURRENT_LIST_DIR}/${package}.lintian-overrides)
    configure_file(${CMAKE_CURRENT_LIST_DIR}/${package}.lintian-overrides ${root}/share/lintian/overrides/${package} COPYONLY)
  endif()
  # As dh_strip does.
  file(GLOB programs ${root}/bin/*)
  file(GLOB_RECURSE archives ${root}/lib/*.a)
  file(GLOB libraries ${root}/lib/*/*.so.*.*.* ${root}/lib/*/vesalius/k4abt/*.so.* ${root}/lib/*/vesalius/nite2/*.so)
  foreach(file IN LISTS programs libraries archives)
    execute_process(COMMAND strip --strip-debug --enable-deterministic-archives --remove-section=.comment --remove-section=.note
                            ${file} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  # Whatever the umask is.
  execute_process(COMMAND chmod -R u=rwX,go=rX ${CPACK_TEMPORARY_DIRECTORY}/${component} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
