#pragma once

#include <memory>
#include <string>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Opens an organised PCD file, or all such files in a folder, as a source of frames. The camera comes from `options`
/// or from a camera file beside the clouds; otherwise it is estimated for each cloud from its points.
std::unique_ptr<FrameSource> open_pcd(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
