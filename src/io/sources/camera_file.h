#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/sources/source_options.h"
#include "vesalius/base/camera.h"

namespace vesalius {

/// What is known about a camera; whatever a file leaves out is empty.
struct CameraFacts {
  std::optional<float> fx, fy, cx, cy;  ///< pixels
  std::optional<int> width, height;     ///< size of the pictures that fx ... cy are for
  std::optional<float> depth_scale;     ///< stored units per metre
  std::string sensor;                   ///< e.g. "Kinect v1"; empty = not named
  bool distorted = false;               ///< the lens has distortion coefficients other than 0
  std::string origin;                   ///< the file, for messages

  /// Takes from `other` what is missing here.
  void fill_from(const CameraFacts& other);
};

/// meta.json: fx fy cx cy (pixels), width height, units ("mm", "cm" or "m", words after it ignored) or depth_scale
/// (stored units per metre), sensor. All may be missing; other keys are ignored. Throws Error naming `name`, the key
/// and what was expected.
CameraFacts parse_meta(std::string_view json, const std::string& name);

/// ROS camera_info YAML, as saved by camera_calibration or printed by rostopic echo. Where there is distortion the
/// rectified camera (projection matrix) is taken. Throws Error naming `name`, the key and what was expected.
CameraFacts parse_camera_info(std::string_view yaml, const std::string& name);

/// Text of a meta.json that `parse_meta` reads back exactly. `depth_scale` in stored units per metre.
std::string serialise_meta(const Camera& camera, float depth_scale = 1000.F);

/// The facts that `options` state, filled from their camera file, or else from meta.json, camera_info.yaml and
/// camera_info.yml in the first of `folders` that has any. Throws Error for an unusable file or value.
CameraFacts find_camera_facts(const SourceOptions& options, const std::vector<std::string>& folders);

/// The camera of pictures of `width` x `height`. fy defaults to fx, the principal point to the centre; without fx the
/// usual focal length of the named sensor is taken (`registered`: depth was warped onto the colour camera's grid).
/// Guesses and assumptions go to `notes`. Throws Error naming `place` when no focal length is known or the facts are
/// for pictures of another size.
Camera resolve_camera(const CameraFacts& facts, int width, int height, bool registered, const std::string& place,
                      std::vector<std::string>& notes);

}  // namespace vesalius
