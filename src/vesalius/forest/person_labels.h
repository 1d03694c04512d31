#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/forest/person_points.h"
#include "vesalius/image.h"

namespace vesalius {

/// The second pass's labels of one person.
struct PersonLabels {
  LabelImage labels;       ///< of the frame's size: the likeliest part of the person's pixels, kBackground elsewhere
  Eigen::VectorXf facing;  ///< probability of each heading (heading_of_yaw); empty where leaves have none
  float certain = 0.F;     ///< mean_certainty of the posteriors that the labels are chosen from
  std::vector<PersonPoint> points = {};  ///< some of the person's pixels with those posteriors
};

}  // namespace vesalius
