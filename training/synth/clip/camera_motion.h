#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "synth/clip/clip_options.h"
#include "synth/clip/person_track.h"
#include "synth/scene/camera_pose.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

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
