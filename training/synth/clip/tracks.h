#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "synth/body/poser.h"
#include "synth/clip/clip_options.h"
#include "synth/pose/movement.h"
#include "synth/scene/camera_pose.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// States a second of what is planned for a clip, whatever the rate of its frames is.
inline constexpr float kTrackRate_hz = 60.F;

/// Where a person is and how, in metres.
struct TrackState {
  Pose pose;
  Eigen::Vector2f at = Eigen::Vector2f::Zero();  ///< x and z of the pelvis in the world
  float heading_rad = 0.F;                       ///< heading of the body frame about y
  float seated = 1.F;                            ///< share of PersonTrack::pelvis_m in the height; 0 is on the floor
};

/// A person over a clip: states at kTrackRate_hz from time 0 on.
struct PersonTrack {
  std::vector<TrackState> states;
  /// Height at which the pelvis stays, of people on seats and beds; empty puts the lowest point on the floor.
  std::optional<float> pelvis_m;

  TrackState at(float time_s) const;
};

/// Returns the number of states of a track that lasts so long.
int track_length(float seconds);

/// Returns the body in a state of its track, in world coordinates.
PosedBody body_at(const Poser& poser, const PersonTrack& track, float time_s);

/// Returns the direction in which a body of this heading looks, and that to its left, as x and z.
Eigen::Vector2f front_of(float heading_rad);
Eigen::Vector2f left_of(float heading_rad);

/// Where the camera is over a clip: world_from_camera at kTrackRate_hz from time 0 on; one pose of a camera that
/// stands.
struct CameraTrack {
  std::vector<Eigen::Isometry3f> poses;

  Eigen::Isometry3f at(float time_s) const;
};

/// How far a moving camera goes from its place at most, metres.
inline constexpr float kCameraReach_m = 0.4F;

/// Moves a camera as a hand or a robot does, about the place of `base`: it drifts and turns within the options' speeds,
/// follows the middle of the people with its view, and in a hand also shakes.
CameraTrack move_camera(const ClipOptions& options, const CameraPose& base, float seconds,
                        const std::vector<PersonTrack>& people, Random& random);

}  // namespace vesalius::synth
