// In place of mkv_recording.cpp where libavformat was not found.
#include "io/recordings/recording_formats.h"
#include "vesalius/error.h"

namespace vesalius {

bool has_mkv() { return false; }

std::unique_ptr<Recording> open_mkv(const std::string& path) {
  throw Error(path + ": this build cannot open Matroska; install libavformat-dev and build again");
}

}  // namespace vesalius
