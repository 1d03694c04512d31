#pragma once

#include <Eigen/Core>
#include <optional>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/detection.h"
#include "vesalius/fit/fitted_body.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius {

/// What one frame tells about how somebody holds the body. Heights are over the floor; what is not seen is not known.
struct Posture {
  std::optional<float> stature_m;   ///< height of the person standing upright, by the fitted body
  std::optional<float> top_m;       ///< height of the person's highest pixels
  std::optional<float> chest_m;     ///< height of the chest, or of the neck or the head where no chest is seen
  std::optional<float> hips_m;      ///< height of the hips
  std::optional<float> trunk_up;    ///< cosine of the trunk's axis, from hips to chest and head, against up; 1 upright
  std::optional<float> thighs_up;   ///< cosine of the thighs' axis, from knees to hips, against up
  std::optional<float> pitch_m;     ///< height of head or neck above the chest
  std::optional<float> vertical_m;  ///< distance between the heights below which 10 and 90 % of the person's pixels are
};

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
