#pragma once

#include <Eigen/Core>
#include <optional>

#include "vesalius/body_model.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius {

/// A body that was fitted to a person, with its model.
struct PosedBody {
  const FittedBody& fitted;
  const FleshModel& flesh;
};

/// Returns the posture of a person; nothing if neither chest nor neck nor head are seen. `up` is the unit vector away
/// from the ground in the optical frame, `height_m` the camera's over the floor, if that is known; without it no
/// heights are. Where hips or knees are not seen, those of the fitted body count if they are rather within 10 cm of
/// the truth than not. What the border of the view cuts off is not known.
std::optional<Posture> posture_of(const Person& person, const Frame& frame, const BodyModel& body,
                                  const Eigen::Vector3f& up, std::optional<float> height_m,
                                  const std::optional<PosedBody>& posed = {});

}  // namespace vesalius
