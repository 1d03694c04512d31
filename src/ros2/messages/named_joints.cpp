#include "ros2/messages/named_joints.h"

#include <algorithm>
#include <numeric>

namespace vesalius::ros2 {

NamedJoints::NamedJoints(const BodyModel& body) : body_(body), sets_(body.joint_sets.size()) {
  std::iota(sets_.begin(), sets_.end(), std::size_t{0});
  std::stable_partition(sets_.begin(), sets_.end(),
                        [&](std::size_t set) { return body.joint_sets[set].name == "k4abt32"; });
}

std::optional<Joint> NamedJoints::find(const TrackedPerson& person, std::string_view name) const {
  const auto& joints = person.smoothed.empty() ? person.person.joints : person.smoothed;
  for (const std::size_t set : sets_) {
    if (set >= joints.size()) continue;
    const auto& names = body_.joint_sets[set].joints;
    const auto found = std::ranges::find(names, name, &JointDefinition::name);
    if (found == names.end()) continue;
    const Joint& joint = joints[set][static_cast<std::size_t>(found - names.begin())];
    if (joint.state != State::none) return joint;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3f> NamedJoints::middle(const TrackedPerson& person, std::string_view a,
                                                   std::string_view b) const {
  const std::optional<Joint> left = find(person, a), right = find(person, b);
  if (!left || !right) return std::nullopt;
  return 0.5F * (left->position + right->position);
}

}  // namespace vesalius::ros2
