#pragma once

#include <array>
#include <optional>

#include "synth/body/body_detail.h"
#include "synth/body/poser.h"
#include "synth/scene/scene.h"

namespace vesalius::synth {

/// A person who is to be in the picture.
struct PersonPlan {
  const Poser* poser = nullptr;        ///< must outlive the call
  const BodyDetail* detail = nullptr;  ///< its coarser surfaces, must outlive the call; none: always the full one
  Pose pose;
  Posture posture = Posture::standing;
  std::array<Material, kFabricCount> look;
  /// Heading, 0 = towards the camera, positive = turned to the person's own left; drawn by the options where not given.
  std::optional<float> yaw_rad;
};

}  // namespace vesalius::synth
