#pragma once

#include <array>
#include <optional>

#include "synth/body/body_detail.h"
#include "synth/body/poser.h"
#include "synth/mesh/scene_mesh.h"

namespace vesalius::synth {

/// A person to be placed in the picture.
struct PersonPlan {
  const Poser* poser = nullptr;        ///< must outlive the call
  const BodyDetail* detail = nullptr;  ///< coarser surfaces, must outlive the call; null uses only the full one
  Pose pose;
  Posture posture = Posture::standing;
  std::array<Material, kFabricCount> look;
  /// The heading: 0 is towards the camera, positive is turned to the person's own left. If it is not given, it is drawn
  /// by the options.
  std::optional<float> yaw_rad;
};

}  // namespace vesalius::synth
