#pragma once

#include <optional>
#include <string_view>
#include <vector>

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

}  // namespace vesalius::ros2
