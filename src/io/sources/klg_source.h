#pragma once

#include <memory>
#include <string>

#include "io/sources/source_options.h"
#include "vesalius/base/frame_source.h"

namespace vesalius {

/// Returns the frames of a log of Kintinuous or ElasticFusion (.klg): a number of frames, and for each its time in
/// microseconds, depth of 16 bits packed by zlib or not at all, and colour on the same grid as JPEG, RGB or none. The
/// file does not state the size of its pictures: it is that of the JPEG or the usual one with so many pixels. Depth is
/// in millimetres unless `options.depth_scale` says otherwise; the camera that of ElasticFusion where nobody gives one
/// and the pictures have 640x480 pixels. Frames are named by their times. Throws Error naming the file and what was
/// expected.
std::unique_ptr<FrameSource> open_klg(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
