#include "vesalius/merge/carry_people.h"

#include "vesalius/track/track_floor.h"

namespace vesalius {

void carry(std::vector<std::vector<Joint>>& joints, const Eigen::Isometry3f& to_from) {
  for (std::vector<Joint>& set : joints) {
    for (Joint& joint : set) joint.position = to_from * joint.position;
  }
}

void carry(FittedBody& body, const Eigen::Isometry3f& to_from) {
  const Eigen::Quaternionf turn(to_from.linear());
  for (FittedBone& bone : body.bones) {
    bone.head = to_from * bone.head;
    bone.tail = to_from * bone.tail;
    bone.global = turn * bone.global;
    bone.covariance = to_from.linear() * bone.covariance * to_from.linear().transpose();
  }
  // The root is turned from the optical frame, all others from their parents.
  if (!body.bones.empty()) body.bones.front().local = turn * body.bones.front().local;
}

void carry(TrackedPerson& person, const Eigen::Isometry3f& to_from, float ahead_s) {
  const Eigen::Isometry3f to = to_from * Eigen::Translation3f(ahead_s * person.velocity);
  person.position = to * person.position;
  person.velocity = to.linear() * person.velocity;
  for (SkeletonPart& part : person.person.skeleton.parts) part.centre = to * part.centre;
  for (VotedPart& part : person.person.skeleton.voted) part.centre = to * part.centre;
  carry(person.person.joints, to);
  carry(person.smoothed, to);
  if (person.body) carry(*person.body, to);
}

FloorView carried(const FloorView& floor, const Eigen::Isometry3f& to_from) {
  Plane plane;
  plane.normal = -(to_from.linear() * floor.up);
  plane.offset = floor.height_m + plane.normal.dot(to_from.translation());
  return view_of_floor(plane);
}

}  // namespace vesalius
