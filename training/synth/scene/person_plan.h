#pragma once

#include <array>
#include <optional>

#include "synth/body/body_detail.h"
#include "synth/body/poser.h"
#include "synth/mesh/scene_mesh.h"
#include "synth/scene/scene.h"

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

/// Returns the surface of a posed body in the world, as coarse as `detail_px` pixels of the view allow at the body's
/// nearest point.
SceneMesh person_mesh(const PersonPlan& plan, const PosedBody& body, const View& view, float detail_px);

/// Returns the body after a motion, for example into the world.
PosedBody moved(PosedBody body, const Eigen::Isometry3f& motion);

}  // namespace vesalius::synth
