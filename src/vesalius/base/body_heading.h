#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "vesalius/body_model.h"

namespace vesalius {

/// Returns the body's axis as a unit vector from the mean of the lower body's parts to the mean of the upper body's, or
/// upwards in the picture where one of the two is not known. `centres` are those of the parts in metres, optical frame;
/// NaN = not known.
Eigen::Vector3f body_up(const std::vector<Eigen::Vector3f>& centres, const BodyModel& body);

/// Returns which way a person is turned about the body's own axis, as the camera sees it: 0 faces the camera, positive
/// is turned to the person's own left, between -pi and pi. It follows from what is left of what and what is above what
/// in the body, so that the camera's roll does not matter and lying people have a heading too.
/// `centres` are those of the parts in metres, optical frame; NaN = not known. Returns nothing where left and right or
/// the viewing direction do not tell it, as for somebody seen along the body's axis.
std::optional<float> body_yaw(const std::vector<Eigen::Vector3f>& centres, const BodyModel& body);

/// Returns the index of the heading that is nearest to a yaw, of so many evenly spaced ones. The first is the front.
int heading_of_yaw(float yaw_rad, int headings);

}  // namespace vesalius
