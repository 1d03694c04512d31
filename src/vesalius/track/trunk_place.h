#pragma once

#include <Eigen/Core>
#include <optional>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius {

/// Where the trunk of a person was measured.
struct TrunkPlace {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< metres, optical frame
  float sigma_m = 0.F;                                 ///< standard deviation along each axis
};

/// Returns the middle of the trunk: the mean of the chest's and the hips' parts where the body names them so and both
/// are known, seen or predicted; otherwise the mean of the seen parts, or without any that of the mask's points, which
/// are less certain. Nothing if the frame has no reading on the mask either.
std::optional<TrunkPlace> trunk_place(const Person& person, const Frame& frame, const BodyModel& body);

}  // namespace vesalius
