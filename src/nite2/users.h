#pragma once

#include <NiteCAPI.h>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "nite2/depth_view.h"
#include "nite2/pose.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius::nite2 {

/// The model's joint set nite15 in the order of the interface.
class NiteJoints {
 public:
  /// Throws Error for a body without the set, or without one of the joints.
  explicit NiteJoints(const BodyModel& body);

  std::size_t set() const { return set_; }  ///< its index
  /// Returns joints of the set in the interface's order.
  Joints ordered(const std::vector<Joint>& joints) const;
  /// Returns the turns of the bones that begin at each, from a T before the camera, optical frame; of the head and of
  /// hands and feet those of themselves. Nothing where nobody knows.
  std::array<std::optional<Eigen::Quaternionf>, NITE_JOINT_COUNT> turns(const TrackedPerson& person) const;

 private:
  std::size_t set_;
  std::array<std::size_t, NITE_JOINT_COUNT> index_{};  ///< in the set
  std::array<int, NITE_JOINT_COUNT> bone_{};           ///< of the fitted body; -1 = none
};

/// Returns the interface's id for one of the tracker's: the same up to 32,767, then from 1 again.
NiteUserId user_id(int id);

/// What a program asks for of a user, and what was told before.
struct Wish {
  bool skeleton = false;
  std::array<bool, NITE_POSE_COUNT> detects{}, held{};
};

/// Returns the skeleton of joints that are in the interface's order. A joint without a place has that of the next joint
/// towards the torso that has one, or of the trunk, and no confidence; so has one without a turn its turn.
NiteSkeleton skeleton_of(const TrackedPerson& person, const Joints& joints, const NiteJoints& set,
                         const DepthView& view);

/// Returns what is told of a pose, and keeps it in `held`.
NitePoseData pose_of(NitePoseType type, bool detects, bool holds, bool& held);

/// Returns the plane of the floor.
NitePlane floor_of(const FloorView& floor, const DepthView& view);

/// Returns the ids of users by pixel of the stream's picture. `people` are those of the frame, `ids` theirs.
std::vector<NiteUserId> user_map(const std::vector<Person>& people, const std::vector<NiteUserId>& ids,
                                 const Frame& frame, const DepthView& view);

/// Tells box and centre of somebody's pixels in the stream's picture, where there are any.
void place_user(const Person& person, const Frame& frame, const DepthView& view, NiteUserData& user);

}  // namespace vesalius::nite2
