#pragma once

#include <utility>

#include "capsule/capsule_person.h"
#include "metrics/frame_truth.h"
#include "vesalius/body_model.h"

namespace vesalius::test {

inline constexpr Camera kCapsuleCamera{160, 120, 131.25F, 131.25F, 79.5F, 59.5F};

/// Returns a frame of a capsule person at this distance with the truth of its parts, turned about the vertical, with
/// the arms raised to the sides by so much.
inline TrueFrame capsule_frame(float distance_m, float turn_rad, float raise_rad = 0.F) {
  CapsuleScene scene;
  CapsulePerson person;
  person.feet.z() = distance_m;
  person.pose.yaw = turn_rad;
  if (raise_rad > 0.F) person.pose.l_arm.raise = person.pose.r_arm.raise = raise_rad;
  scene.people.push_back(person);
  LabelledFrame labelled = render(scene, kCapsuleCamera, paper_body());
  TrueFrame frame;
  frame.frame = std::move(labelled.frame);
  frame.truth.people = 1;
  frame.truth.parts = std::move(labelled.parts);
  frame.truth.person = std::move(labelled.person);
  frame.truth.labels = std::move(labelled.labels);
  return frame;
}

}  // namespace vesalius::test
