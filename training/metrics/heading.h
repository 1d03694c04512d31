#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metrics/frame_truth.h"
#include "vesalius/body_model.h"

namespace vesalius {

/// Returns the mean of the points that are known (not NaN), or zero.
Eigen::Vector3f mean_known(const std::vector<Eigen::Vector3f>& points);

/// Points of a body of which some have a partner on the other side.
struct SidedNames {
  std::vector<std::string> names;
  std::vector<int> partner;  ///< index of the point on the other side; -1 on the middle line

  bool is_left(std::size_t point) const { return names[point].starts_with("l_"); }
};

/// Returns the body's parts with their mirror partners.
SidedNames sided(const BodyModel& body);
/// Returns joints of these names; l_... and r_... are partners.
SidedNames sided(const std::vector<std::string>& names);

/// Returns the side that a person turns to the camera, from the points called l_... and their partners (metres, optical
/// frame; NaN = not known), as seen from above. Returns nothing for somebody whose left and right lie above each other,
/// as when lying on a side, or if no pair is known.
std::optional<Heading> heading_of(const SidedNames& names, const std::vector<Eigen::Vector3f>& points);

/// Returns the heading of a true person: from the centres of the parts by body_yaw, from the truth of the whole frame,
/// or from the joints, whichever is known first.
std::optional<Heading> heading_of(const FrameTruth& truth, std::size_t person, const BodyModel& body);

}  // namespace vesalius
