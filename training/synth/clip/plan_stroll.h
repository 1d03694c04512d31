#pragma once

#include <optional>
#include <vector>

#include "synth/clip/clip_options.h"
#include "synth/clip/stroll.h"
#include "synth/scene/camera_pose.h"
#include "synth/scene/occupancy.h"
#include "synth/scene/scene.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// What is there when a person's way is planned.
struct StrollGround {
  View view;                                             ///< of the camera in the middle of the places to which it goes
  float camera_reach_m = 0.F;                            ///< how far the camera goes from there
  std::vector<OrientedBox> solids;                       ///< seats, beds and tables in the world
  std::vector<PersonTrack> people;                       ///< who is there already
  std::vector<std::vector<Eigen::Vector2f>> footprints;  ///< x and z of bones of those who stay on seats and beds
};

/// What is asked of a way.
struct StrollWish {
  bool walks = true;    ///< false stays at the first place
  bool crosses = true;  ///< passes before or behind somebody who is there, as far as that is possible
};

/// Returns whether two people pass before each other in the picture of `view` between two times.
bool cross(const View& view, const PersonTrack& a, const PersonTrack& b, float from_s, float to_s);

/// Plans where a person walks and stays for so many seconds: places in the camera's view and at its distances, now and
/// then outside. Keeps 0.75 m from other people's middles, 0.35 m from things, and away from the camera. Returns
/// nothing if no way is found after a bounded number of tries. The same arguments give the same way.
std::optional<PersonTrack> plan_stroll(const ClipOptions& options, const CameraPlacement& placement,
                                       const StrollGround& ground, const Repertoire& can, const StrollWish& wish,
                                       float seconds, Random& random);

}  // namespace vesalius::synth
