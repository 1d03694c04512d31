# Run by cpack after it packed: packs the archive anew, without who made it, when, and in which order the files lie on the disk.
if(NOT CPACK_GENERATOR STREQUAL "TGZ")
  return()
endif()
get_filename_component(staging ${CPACK_TEMPORARY_DIRECTORY} DIRECTORY)
get_filename_component(folder ${CPACK_TEMPORARY_DIRECTORY} NAME)
execute_process(
  COMMAND tar --create --format=gnu --sort=name --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX
          --mtime=@$ENV{SOURCE_DATE_EPOCH} --directory=${staging} ${folder}
  COMMAND gzip -9n
  OUTPUT_FILE ${CPACK_PACKAGE_FILES} COMMAND_ERROR_IS_FATAL ANY)
