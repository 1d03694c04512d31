#pragma once

#include <string>
#include <vector>

namespace vesalius {

/// Returns whether a file is a recording by its name: "x.bag", also "x.bag.active", which rosbag did not close, and
/// "x.db3.zstd", which rosbag2 packed.
bool has_recording_name(const std::string& path);

/// Returns whether a folder has recordings.
bool has_recordings(const std::string& folder);

/// Returns the files of a folder that are one recording, in their order: those of rosbag2, with or without
/// metadata.yaml, or what `rosbag record --split` wrote. Empty where there are none. Throws Error where there are
/// several that are no parts of each other: files of one recording end in _0, _1 and so on.
std::vector<std::string> list_recording(const std::string& folder);

}  // namespace vesalius
