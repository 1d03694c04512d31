#pragma once

#include <functional>
#include <optional>
#include <string>

namespace vesalius {

/// Facts that the files of a source may not state, and what to do where a camera is lost. Values given here replace
/// those in files.
struct SourceOptions {
  std::optional<float> fx, fy, cx, cy;  ///< pixels; fy defaults to fx, cx and cy to the picture's centre
  std::optional<float> depth_scale;     ///< stored units per metre (1000 = millimetres, 5000 = TUM)
  std::string camera_file;              ///< path of a meta.json or ROS camera_info YAML
  std::string colour_file;              ///< path of the colour picture for a single depth PNG
  std::string depth_topic;              ///< or stream, of a recording; empty = chosen
  std::string colour_topic;             ///< or stream, of a recording; empty = one registered to depth, or none
  std::optional<double> start_s;        ///< first frame to give, in seconds from the source's first; not of a camera
  bool reconnect = false;               ///< whether a camera that is lost is waited for; otherwise that is an error
  /// Gets one line when such a camera is lost and one when it is back, in the thread that calls `next`; may be empty.
  std::function<void(const std::string&)> say = {};
};

}  // namespace vesalius
