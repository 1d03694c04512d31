#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/forest/posteriors.h"

namespace vesalius {

/// A point that the camera sees on a person, and which parts it may belong to.
struct PersonPoint {
  static constexpr int kParts = 3;
  Eigen::Vector3f at;                       ///< metres, optical frame
  std::array<std::uint8_t, kParts> part{};  ///< the likeliest first; kBackground where there are fewer
  std::array<float, kParts> share{};        ///< probability of each among all parts, 0-1
};

/// Most points of a part.
inline constexpr int kPointsOfPart = 16;

/// Returns up to kPointsOfPart points of each part, evenly spread over the pixels with that label. `labels` has the
/// depth's size and is kBackground off the person, who is within `box`. `posteriors` are those of the pixels of `of`, a
/// box around `box`; their first `parts` classes are the parts.
std::vector<PersonPoint> sample_points(const DepthImage& depth, const Camera& camera, const LabelImage& labels,
                                       const Box& box, const Posteriors& posteriors, const Box& of, int parts);

}  // namespace vesalius
