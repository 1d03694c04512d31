#pragma once

#include <memory>
#include <string>

#include "vesalius/base/frame_source.h"

namespace vesalius {

/// Returns whether a file begins as a recording of OpenNI. Throws Error naming `path` if it cannot be opened.
bool is_oni(const std::string& path);

/// Returns the frames of a recording of OpenNI 1 or 2 (.oni). Depth comes as millimetres, tenths of them, or shifts
/// with their table; the focal length from the field of view. A frame has the colour nearest in time, at most 50 ms
/// away, where the recording says that depth is registered to it, or `options.colour_topic` names its stream; so does
/// `depth_topic` for one of several of depth. Mirrored pictures are turned back. Frames are named by their times, which
/// count from the first. Throws Error naming the file and what was expected.
std::unique_ptr<FrameSource> open_oni(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
