#pragma once

// Glossary
//   offset  where a probe looks, in the unit of the convention; scaled by 1/depth so that a feature covers the same
//           part of a body at any distance (eq. 1).
//   probe   one depth read. Holes and reads outside the picture have values of their own.
//   walk    from the root to a leaf. Integers only: the same leaf on every machine.

#include <algorithm>
#include <cstdint>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// Pixels per offset unit at one depth, in 1/65536 pixel.
struct OffsetScale {
  std::int32_t u = 0;
  std::int32_t v = 0;
};

/// Scale of the offsets at every depth for one camera and convention.
class OffsetScaler {
 public:
  OffsetScaler(const FeatureConvention& convention, const Camera& camera)
      : unit_u_(65536.0 * 1000.0 * convention.offset_unit / convention.reference_focal_px * camera.fx),
        unit_v_(65536.0 * 1000.0 * convention.offset_unit / convention.reference_focal_px * camera.fy) {}

  /// `depth_mm` > 0. Saturates at 32 pixels a unit: for units of 12 mm and a focal length of 525 pixels
  /// nearer than 20 cm.
  OffsetScale at(std::uint16_t depth_mm) const {
    return {static_cast<std::int32_t>(std::min(unit_u_ / depth_mm, kMaxScale)),
            static_cast<std::int32_t>(std::min(unit_v_ / depth_mm, kMaxScale))};
  }

 private:
  static constexpr double kMaxScale = 32.0 * 65536.0;
  double unit_u_;
  double unit_v_;
};

/// Depth read by the probe of pixel (u, v) at offset (du, dv), before clipping. Rounds to the nearest pixel.
inline int probe_mm(const DepthImage& depth, const FeatureConvention& convention, OffsetScale scale, int u, int v,
                    int du, int dv) {
  const int pu = u + ((du * scale.u + 32768) >> 16);
  const int pv = v + ((dv * scale.v + 32768) >> 16);
  if (!depth.contains(pu, pv)) return convention.outside_mm;
  const int read = depth(pu, pv);
  return read != 0 ? read : convention.hole_mm;
}

/// Eq. 1, in millimetres.
inline int feature_mm(const DepthImage& depth, const FeatureConvention& convention, OffsetScale scale, int u, int v,
                      const TreeNode& node) {
  int first = probe_mm(depth, convention, scale, u, v, node.du1, node.dv1);
  int second = probe_mm(depth, convention, scale, u, v, node.du2, node.dv2);
  if (convention.clip_mm != 0) {
    const int low = depth(u, v) - convention.clip_mm;
    const int high = depth(u, v) + convention.clip_mm;
    first = std::clamp(first, low, high);
    second = std::clamp(second, low, high);
  }
  return first - second;
}

/// The child of an inner node that pixel (u, v), which must have a reading, goes to: a node, or ~leaf.
inline std::int32_t step(const Tree& tree, std::int32_t at, const DepthImage& depth,
                         const FeatureConvention& convention, OffsetScale scale, int u, int v) {
  const TreeNode& node = tree.nodes[at];
  return feature_mm(depth, convention, scale, u, v, node) <= node.threshold_mm ? node.left : node.right;
}

/// Leaf that the pixel reaches.
inline const TreeLeaf& walk(const Tree& tree, const DepthImage& depth, const FeatureConvention& convention,
                            OffsetScale scale, int u, int v) {
  std::int32_t at = tree.nodes.empty() ? ~0 : 0;
  while (at >= 0) at = step(tree, at, depth, convention, scale, u, v);
  return tree.leaves[~at];
}

}  // namespace vesalius
