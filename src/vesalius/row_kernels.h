#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/person.h"

/// What stages ask of the pixels of a row, on vectors. The results are those of plain code for every instruction set.
namespace vesalius {

/// Sums of a pixel's posteriors: of those of the parts, and of all. All are 0 where depth has no reading.
struct BodySums {
  std::int32_t body = 0, all = 0;

  /// As body_share.
  std::optional<double> share() const { return all > 0 ? std::optional(double(body) / all) : std::nullopt; }
};
/// Writes the sums of `count` pixels from (u, v) on; 0 where `skip` is not. The parts are the first `parts` classes.
void sum_bodies(const Posteriors& posteriors, int u, int v, int parts, const std::uint8_t* skip, int count,
                BodySums* sums);

/// Sets the pixels of a box in `mask` that lie within `radius_m` of a point to 1.
void mark_near(const DepthImage& depth, const Camera& camera, const Eigen::Vector3f& point, float radius_m,
               const Box& box, Mask& mask);

/// The points of a row's pixels, metres, optical frame.
struct PointRow {
  std::vector<float> x, y, z;
};
/// Lowers `distance`, that of the points from `begin` to before `end`, to Capsule::distance where that is less, and
/// less than `reach_m`. Points without a reading, or not from `nearest_m` to `farthest_m` away, keep what they have.
void lower_distances(const PointRow& points, std::size_t begin, std::size_t end, const Capsule& capsule,
                     float nearest_m, float farthest_m, float reach_m, float* distance);

/// Writes the hues of `count` colours, in `hues` steps around the circle, the first in the middle of red. Where a
/// colour is too dark or too grey to have one, it is `hues` and an eighth of the brightest channel.
void classify_hues(const Rgb* colours, int count, int hues, std::uint16_t* classes);

}  // namespace vesalius
