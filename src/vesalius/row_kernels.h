#pragma once

#include <cstdint>

#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"

/// What stages ask of the pixels of a row, on vectors. The results are those of plain code for every instruction set.
namespace vesalius {

/// Sums of a pixel's posteriors: of those of the parts, and of all. All are 0 where depth has no reading.
struct BodySums {
  std::int32_t body = 0, all = 0;
};
/// Writes the sums of `count` pixels from (u, v) on; 0 where `skip` is not. The parts are the first `parts` classes.
void sum_bodies(const Posteriors& posteriors, int u, int v, int parts, const std::uint8_t* skip, int count,
                BodySums* sums);

/// Sets the pixels of a box in `mask` that lie within `radius_m` of a point to 1.
void mark_near(const DepthImage& depth, const Camera& camera, const Eigen::Vector3f& point, float radius_m,
               const Box& box, Mask& mask);

/// Writes the hues of `count` colours, in `hues` steps around the circle, the first in the middle of red. Where a
/// colour is too dark or too grey to have one, it is `hues` and an eighth of the brightest channel.
void classify_hues(const Rgb* colours, int count, int hues, std::uint16_t* classes);

}  // namespace vesalius
