#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/recordings/transform_messages.h"
#include "vesalius/body_model.h"
#include "vesalius/person.h"

namespace vesalius::ros2 {

/// Finds joints by their names, such as "l_elbow", whichever joint set has them: first in k4abt32, whose joints are
/// those of the fitted body, then in the others in the body model's order.
class NamedJoints {
 public:
  /// The body model must outlive this object.
  explicit NamedJoints(const BodyModel& body);

  /// Returns a joint with a place, smoothed where that was asked for; nothing if the person has none of that name.
  std::optional<Joint> find(const TrackedPerson& person, std::string_view name) const;
  /// Returns the place between two joints; nothing if one is missing.
  std::optional<Eigen::Vector3f> middle(const TrackedPerson& person, std::string_view a, std::string_view b) const;

 private:
  const BodyModel& body_;
  std::vector<std::size_t> sets_;  ///< in the order in which they are asked
};

/// Returns where a person's body and joints stand, as REP-155 names them: body_<id> in the camera's frame, and in
/// body_<id> those links of human_description that are joints of a person: waist, torso, head, shoulders, elbows,
/// wrists, hips, knees, ankles (l_elbow_<id> and so on); those without a place are left out.
///
/// Axes are those of human_description: x forward, y to the person's left, z up; of a limb z points from its end to the
/// joint, and elbows and knees turn about y. body_<id> stands in the pelvis, its z along the spine. `up` points away
/// from the ground, for whoever shows too little of the trunk. The head has the trunk's axes, since nothing measures
/// its own.
std::vector<FrameTransform> human_frames(const TrackedPerson& person, const NamedJoints& joints, const std::string& id,
                                         const std::string& camera_frame, const Eigen::Vector3f& up);

}  // namespace vesalius::ros2
