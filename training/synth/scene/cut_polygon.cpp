#include "synth/scene/cut_polygon.h"

#include <algorithm>
#include <numeric>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// Returns a vector along the polygon's normal whose length is twice its area (Newell).
Vector3f normal_of(const std::vector<Vector3f>& corners) {
  Vector3f sum = Vector3f::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sum += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
  }
  return sum;
}

}  // namespace

std::vector<Triangle> cut_polygon(const std::vector<Vector3f>& corners) {
  const Vector3f normal = normal_of(corners);
  std::vector<std::uint32_t> left(corners.size());
  std::iota(left.begin(), left.end(), 0U);
  const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return (corners[b] - corners[a]).cross(corners[c] - corners[a]).dot(normal);
  };
  const auto is_ear = [&](std::size_t i) {
    const std::uint32_t a = left[(i + left.size() - 1) % left.size()], b = left[i], c = left[(i + 1) % left.size()];
    if (!(turn(a, b, c) > 0.F)) return false;
    return std::ranges::none_of(left, [&](std::uint32_t p) {
      return p != a && p != b && p != c && turn(a, b, p) >= 0.F && turn(b, c, p) >= 0.F && turn(c, a, p) >= 0.F;
    });
  };
  std::vector<Triangle> triangles;
  while (left.size() > 3) {
    std::size_t ear = 1;  // if no corner is an ear, any is cut
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (!is_ear((i + 1) % left.size())) continue;
      ear = (i + 1) % left.size();
      break;
    }
    triangles.push_back({left[(ear + left.size() - 1) % left.size()], left[ear], left[(ear + 1) % left.size()]});
    left.erase(left.begin() + std::ptrdiff_t(ear));
  }
  if (left.size() == 3) triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace vesalius::synth
