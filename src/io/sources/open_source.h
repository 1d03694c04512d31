#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/base/frame.h"

namespace vesalius {

/// A stream of frames: a folder, a file, a sensor.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frame, or nothing at the end. Throws Error for a file that cannot be read.
  virtual std::optional<Frame> next() = 0;
  /// Number of frames in all, -1 where not known.
  virtual int size() const = 0;
  /// What a user should know: guessed intrinsics, colour without partner. One line each.
  virtual std::vector<std::string> notes() const { return {}; }
};

/// What the files themselves may leave open. Values given here win over those in files.
struct SourceOptions {
  std::optional<float> fx, fy, cx, cy;  ///< pixels; fy defaults to fx, cx and cy to the picture's centre
  std::optional<float> depth_scale;     ///< stored units per metre (1000 = millimetres, 5000 = TUM)
  std::string camera_file;              ///< meta.json or ROS camera_info YAML
  std::string colour_file;              ///< partner of a single depth PNG
};

/// The only factory of sources. `uri` is
///   a folder with depth/*.png (rgb/ or color/ optional) and meta.json or camera_info.yaml,
///   a folder of depth PNG files, of PCD files, or in the TUM RGB-D layout (depth.txt),
///   a depth PNG or an organised PCD file,
/// optionally with a scheme that says which: folder:, tum:, pcd:, png:  and, for tum:, a scale: "tum:walking:1000".
/// Throws Error with the path and what was expected.
std::unique_ptr<FrameSource> open_source(const std::string& uri, const SourceOptions& options = {});

/// A frame over buffers of the caller, copied: `depth_mm` width x height values, `rgb` three bytes a pixel or null.
/// Strides are in bytes; 0 = packed.
Frame make_frame(const Camera& camera, const std::uint16_t* depth_mm, std::size_t depth_stride,
                 const std::uint8_t* rgb = nullptr, std::size_t rgb_stride = 0);

}  // namespace vesalius
