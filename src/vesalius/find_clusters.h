#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/camera.h"
#include "vesalius/image.h"
#include "vesalius/people_options.h"

namespace vesalius {

/// A part proposal: a connected set of pixels of one label (section 5). Metres, optical frame.
struct PartCluster {
  int label = -1;
  int pixels = 0;
  int first_pixel = -1;  ///< row-major index of its first pixel
  float area_m2 = 0.F;   ///< sum of the pixels' areas perpendicular to the viewing direction
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  Eigen::Vector3f eigenvalues = Eigen::Vector3f::Zero();  ///< those of the covariance, largest first, m²
  float extent_m = 0.F;  ///< length of the rod with the variance of the first axis: sqrt(12 * eigenvalue)
};

struct Clusters {
  std::vector<PartCluster> items;  ///< largest area first within each label, labels ascending
  Image<std::int32_t> index;       ///< index of each pixel's item, or -1
};

/// Returns the part proposals of a labelling, found by breadth-first search over the 8-neighbourhood (section 5).
/// Neighbours with equal labels that are closer than the gap belong to one cluster. Clusters that are too small, or
/// longer than their part can be, are dropped. Pixels without a reading, or outside of `within`, belong to none.
Clusters find_clusters(const LabelImage& labels, const DepthImage& depth, const Camera& camera, const BodyModel& body,
                       const ClusterOptions& options, const Box& within);

/// Does so in the whole picture.
inline Clusters find_clusters(const LabelImage& labels, const DepthImage& depth, const Camera& camera,
                              const BodyModel& body, const ClusterOptions& options) {
  return find_clusters(labels, depth, camera, body, options, {0, 0, labels.width(), labels.height()});
}

}  // namespace vesalius
