#include "synth/body/body_detail.h"

#include "synth/pose/joint_angles.h"

namespace vesalius::synth {
namespace {

/// Returns a pose with every joint half bent, so that surfaces that bend are not flat in it.
Pose half_bent() {
  BodyAngles angles;
  angles.trunk = {30.F, 10.F, 15.F};
  angles.neck = {20.F, 10.F, 20.F};
  for (ArmAngles& arm : angles.arms) {
    arm.elevation = 50.F;
    arm.plane = 45.F;
    arm.elbow = 60.F;
    arm.pronation = 30.F;
    arm.wrist = 25.F;
  }
  for (LegAngles& leg : angles.legs) {
    leg.flexion = 50.F;
    leg.abduction = 15.F;
    leg.external = 15.F;
    leg.knee = 60.F;
    leg.ankle = 10.F;
  }
  angles.grip = {0.5F, 0.5F};
  return pose_of(angles);
}

}  // namespace

BodyDetail::BodyDetail(const Poser& poser) {
  levels_ = simplify(*poser.mesh().topology, poser.pose(half_bent()).vertices,
                     {0.0005F, 0.0008F, 0.0013F, 0.002F, 0.0032F, 0.005F});
}

const CoarseSurface* BodyDetail::within(float error_m) const {
  const CoarseSurface* coarsest = nullptr;
  for (const CoarseSurface& level : levels_) {
    if (level.error_m <= error_m) coarsest = &level;
  }
  return coarsest;
}

}  // namespace vesalius::synth
