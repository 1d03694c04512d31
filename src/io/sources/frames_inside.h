#pragma once

#include <string>

namespace vesalius {

/// Returns whether a folder seems to hold frames or recordings, by names and the first picture's head.
bool has_frames(const std::string& folder);

/// Says which folder below a folder has frames, the least deep one first, as "; PATH has some"; "" where none has.
std::string frames_below(const std::string& path);

}  // namespace vesalius
