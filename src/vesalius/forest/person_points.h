#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "vesalius/camera.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/person.h"

namespace vesalius {

/// Most points of a part.
inline constexpr int kPointsOfPart = 16;

/// Returns up to kPointsOfPart points of each part, evenly spread over the pixels with that label. `labels` has the
/// depth's size and is kBackground off the person, who is within `box`. `posteriors` are those of the pixels of `of`, a
/// box around `box`; their first `parts` classes are the parts.
std::vector<PersonPoint> sample_points(const DepthImage& depth, const Camera& camera, const LabelImage& labels,
                                       const Box& box, const Posteriors& posteriors, const Box& of, int parts);

/// The second pass's labels of one person.
struct PersonLabels {
  LabelImage labels;  ///< picture of the frame's size: the likeliest part of the person's pixels, kBackground elsewhere
  Eigen::VectorXf facing;                ///< probability of each heading (heading_of_yaw); empty where leaves have none
  float certain = 0.F;                   ///< mean_certainty of the posteriors that the labels are chosen from
  std::vector<PersonPoint> points = {};  ///< some of the person's pixels with those posteriors
};

}  // namespace vesalius
