#pragma once

#include <memory>
#include <string>

#include "io/sources/source_options.h"
#include "vesalius/base/frame_source.h"

namespace vesalius {

/// Frames of an organised PCD file or of all those in a folder. The camera is that of `options` or of the files beside;
/// without, each cloud's own, estimated from its points.
std::unique_ptr<FrameSource> open_pcd(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
