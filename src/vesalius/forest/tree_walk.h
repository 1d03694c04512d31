#pragma once

// Glossary
//   offset  where a probe looks, in the unit of the convention. It is scaled by 1/depth, so that a feature covers the
//           same part of a body at any distance (eq. 1).
//   probe   one depth read. Holes and places outside the picture read as the convention says.
//   walk    the way from the root to a leaf. It takes integers only, so that it ends in the same leaf on every machine.

#include <cstdint>

#include "vesalius/camera.h"
#include "vesalius/forest.h"
#include "vesalius/forest/feature.h"
#include "vesalius/image.h"

namespace vesalius {

/// Scales node offsets at every depth for one camera and convention.
class OffsetScaler {
 public:
  OffsetScaler(const FeatureConvention& convention, const Camera& camera)
      : unit_u_(65536.0 * 1000.0 * convention.offset_unit / convention.reference_focal_px * camera.fx),
        unit_v_(65536.0 * 1000.0 * convention.offset_unit / convention.reference_focal_px * camera.fy) {}

  /// Returns the scale at `depth_mm`, which must be above 0. It saturates at 32 pixels a unit: for units of 12 mm and a
  /// focal length of 525 pixels that is nearer than 20 cm.
  OffsetScale at(std::uint16_t depth_mm) const {
    return {offset_scale(unit_u_, depth_mm), offset_scale(unit_v_, depth_mm)};
  }
  /// Returns the scales that 1 mm of depth would have if they did not saturate.
  double unit_u() const { return unit_u_; }
  double unit_v() const { return unit_v_; }

 private:
  double unit_u_;
  double unit_v_;
};

/// Returns what a probe at (u, v) reads, inside or outside the picture, in millimetres.
inline int probe_mm(const DepthImage& depth, const FeatureConvention& convention, int u, int v) {
  if (!depth.contains(u, v)) return convention.outside_mm;
  const int read = depth(u, v);
  return read != 0 ? read : convention.hole_mm;
}

/// Returns the feature of pixel (u, v), which must have a reading, in millimetres (feature.h).
inline int feature_mm(const DepthImage& depth, const FeatureConvention& convention, OffsetScale scale, int u, int v,
                      const TreeNode& node) {
  return feature(u, v, scale, probe_range(depth(u, v), convention.clip_mm), node,
                 [&](int pu, int pv) { return probe_mm(depth, convention, pu, pv); });
}

/// Returns the child of node `at` that pixel (u, v) goes to: an index of a node, or ~index of a leaf. The pixel must
/// have a reading.
inline std::int32_t step(const Tree& tree, std::int32_t at, const DepthImage& depth,
                         const FeatureConvention& convention, OffsetScale scale, int u, int v) {
  const TreeNode& node = tree.nodes[at];
  return feature_mm(depth, convention, scale, u, v, node) <= node.threshold_mm ? node.left : node.right;
}

/// Returns the leaf that pixel (u, v), which must have a reading, reaches.
inline const TreeLeaf& walk(const Tree& tree, const DepthImage& depth, const FeatureConvention& convention,
                            OffsetScale scale, int u, int v) {
  std::int32_t at = tree.nodes.empty() ? ~0 : 0;
  while (at >= 0) at = step(tree, at, depth, convention, scale, u, v);
  return tree.leaves[~at];
}

}  // namespace vesalius
