#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/camera.h"
#include "vesalius/image.h"

namespace vesalius {

/// One RGB-D picture: depth, colour registered to it (or none), and the camera of the depth grid.
struct Frame {
  std::string name;              ///< file stem or time stamp; unique within a source
  std::optional<double> time_s;  ///< seconds since any moment the source counts from; none where it has no times
  Camera camera;
  DepthImage depth;
  ColourImage colour;  ///< empty, or the size of `depth`
  /// When a live source got it, seconds since 1970 by this machine's clock; none otherwise. `time_s` is the camera's.
  std::optional<double> arrived_s = std::nullopt;
  /// Unit vector away from the ground in the optical frame, as a sensor of acceleration measured it; none without one.
  std::optional<Eigen::Vector3f> up = std::nullopt;
  /// Quarter turns clockwise, 0 to 3, after which the picture is upright; none where nobody says so: then `up` tells.
  std::optional<int> quarter_turns = std::nullopt;
};

/// Returns a frame of nothing but depth.
inline Frame depth_frame(DepthImage depth, const Camera& camera) { return {{}, {}, camera, std::move(depth), {}}; }

/// Returns the point that pixel (u, v) of a depth image sees; its z is 0 where there is no reading.
inline Eigen::Vector3f point_at(const Camera& camera, const DepthImage& depth, int u, int v) {
  return camera.point(float(u), float(v), float(depth(u, v)) * 1e-3F);
}

/// Throws Error unless depth has the camera's size and colour is empty or has it too.
void check(const Frame& frame);

/// Whether joints or parts were seen, or inferred from others.
enum class State { none, predicted, observed };
const char* to_string(State state);

/// A frame with its truth: what training and evaluation consume.
struct LabelledFrame {
  Frame frame;
  LabelImage labels;                                ///< true part of every pixel; kBackground elsewhere
  Image<std::uint8_t> person;                       ///< true person index of every pixel; kBackground elsewhere
  std::vector<std::vector<Eigen::Vector3f>> parts;  ///< [person][part]: centre of the part's volume, metres
  /// [person][joint]: where joints of the skeleton are, metres, optical frame; empty where nobody knows. Whoever makes
  /// the frames names them, the same ones in all (synth/body/poser.h; DatasetInfo::joints).
  std::vector<std::vector<Eigen::Vector3f>> joints;
  std::vector<std::string> postures;     ///< [person]: one word, e.g. "sitting"; empty where nobody knows
  std::optional<Eigen::Vector3f> up;     ///< unit vector away from the ground, optical frame
  std::optional<float> camera_height_m;  ///< height of the camera above the ground on which people stand
  /// Pose of the camera in a world that stays the same over a recording: metres, y away from the ground, which is y =
  /// 0.
  std::optional<Eigen::Isometry3f> world_from_camera;
};

}  // namespace vesalius
