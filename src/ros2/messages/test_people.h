#pragma once

// People of whom everything is known, as if they had been found and followed.

#include <algorithm>
#include <vector>

#include "capsule/capsule_person.h"
#include "vesalius/derive_joints.h"
#include "vesalius/person.h"

namespace vesalius::ros2::test {

/// Returns a standing person at the left and one at the right, both facing the camera, in a room.
inline LabelledFrame two_people(int width, int height) {
  CapsuleScene scene;
  scene.people.resize(2);
  scene.people[0].feet = {-0.6F, 1.F, 2.5F};
  scene.people[1].feet = {0.6F, 1.F, 3.F};
  const auto focal = 0.8F * static_cast<float>(width);
  const Camera camera{
      width, height, focal, focal, 0.5F * static_cast<float>(width - 1), 0.5F * static_cast<float>(height - 1)};
  LabelledFrame made = render(scene, camera, paper_body());
  made.frame.name = "two";
  return made;
}

inline Box box_around(const Mask& mask) {
  int left = mask.width(), top = mask.height(), right = -1, bottom = -1;
  for (int v = 0; v < mask.height(); ++v) {
    for (int u = 0; u < mask.width(); ++u) {
      if (mask(u, v) == 0) continue;
      left = std::min(left, u);
      right = std::max(right, u);
      top = std::min(top, v);
      bottom = std::max(bottom, v);
    }
  }
  return {left, top, right - left + 1, bottom - top + 1};
}

/// Returns a person of the truth under an id.
inline TrackedPerson person_of(const LabelledFrame& truth, std::uint8_t index, int id) {
  TrackedPerson person;
  person.id = id;
  person.state = TrackState::tracked;
  const int width = truth.labels.width(), height = truth.labels.height();
  person.person.mask = Mask(width, height);
  person.person.labels = LabelImage(width, height, kBackground);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      if (truth.person(u, v) != index) continue;
      person.person.mask(u, v) = 1;
      person.person.labels(u, v) = truth.labels(u, v);
    }
  }
  for (const Eigen::Vector3f& centre : truth.parts[index]) {
    SkeletonPart part;
    part.state = State::observed;
    part.centre = centre;
    part.confidence = 0.75F;
    person.person.skeleton.parts.push_back(part);
  }
  person.person.joints = derive_joints(paper_body(), person.person.skeleton);
  person.person.box = box_around(person.person.mask);
  person.person.score = 0.75F;
  person.position = truth.parts[index][static_cast<std::size_t>(paper_body().find_part("r_hips"))];
  return person;
}

/// Returns them with the ids 3 and 12.
inline TrackedFrame tracked(const LabelledFrame& truth) {
  TrackedFrame frame;
  frame.people = {person_of(truth, 0, 3), person_of(truth, 1, 12)};
  return frame;
}

}  // namespace vesalius::ros2::test
