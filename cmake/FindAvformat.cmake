# libavformat of FFmpeg: files of Matroska. Defines Avformat::Avformat.
find_path(Avformat_INCLUDE_DIR libavformat/avformat.h)
find_library(Avformat_LIBRARY avformat)
find_library(Avformat_CODEC_LIBRARY avcodec)
find_library(Avformat_UTIL_LIBRARY avutil)
mark_as_advanced(Avformat_INCLUDE_DIR Avformat_LIBRARY Avformat_CODEC_LIBRARY Avformat_UTIL_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Avformat REQUIRED_VARS Avformat_LIBRARY Avformat_CODEC_LIBRARY Avformat_UTIL_LIBRARY
                                                         Avformat_INCLUDE_DIR)
if(Avformat_FOUND AND NOT TARGET Avformat::Avformat)
  add_library(Avformat::Avformat UNKNOWN IMPORTED)
  set_target_properties(
    Avformat::Avformat
    PROPERTIES IMPORTED_LOCATION "${Avformat_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${Avformat_INCLUDE_DIR}"
               INTERFACE_LINK_LIBRARIES "${Avformat_CODEC_LIBRARY};${Avformat_UTIL_LIBRARY}")
endif()
