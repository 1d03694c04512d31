#include "vesalius/forest/person_points.h"

#include <algorithm>
#include <numeric>

namespace vesalius {
namespace {

/// Fills in the likeliest parts of a pixel by its posteriors.
void add_parts(const std::uint16_t* sums, int parts, PersonPoint& point) {
  const int all = std::accumulate(sums, sums + parts, 0);
  std::array<int, PersonPoint::kParts> best{};
  point.part.fill(kBackground);
  for (int p = 0; p < parts; ++p) {
    int at = PersonPoint::kParts;
    while (at > 0 && sums[p] > best[at - 1]) --at;
    for (int i = PersonPoint::kParts - 1; i > at; --i) {
      best[i] = best[i - 1];
      point.part[i] = point.part[i - 1];
    }
    if (at == PersonPoint::kParts) continue;
    best[at] = sums[p];
    point.part[at] = static_cast<std::uint8_t>(p);
  }
  for (int i = 0; i < PersonPoint::kParts; ++i) {
    point.share[i] = all > 0 ? float(best[i]) / float(all) : 0.F;
  }
}

}  // namespace

std::vector<PersonPoint> sample_points(const DepthImage& depth, const Camera& camera, const LabelImage& labels,
                                       const Box& box, const Posteriors& posteriors, const Box& of, int parts) {
  std::array<int, 256> counts{};
  const auto each = [&](const auto& take) {
    for (int v = box.v; v < box.v + box.height; ++v) {
      const std::uint8_t* row = labels.row(v);
      const std::uint16_t* readings = depth.row(v);
      for (int u = box.u; u < box.u + box.width; ++u) {
        if (row[u] < parts && readings[u] != 0) take(u, v, row[u]);
      }
    }
  };
  each([&](int, int, std::uint8_t part) { ++counts[part]; });
  std::array<int, 256> seen{};
  std::vector<PersonPoint> points;
  each([&](int u, int v, std::uint8_t part) {
    // A part's pixels are divided into as many stretches as it gets points; the last pixel of each is taken.
    const std::int64_t wanted = std::min(kPointsOfPart, counts[part]);
    const std::int64_t k = seen[part]++;
    if ((k + 1) * wanted / counts[part] == k * wanted / counts[part]) return;
    PersonPoint& point = points.emplace_back();
    const float z_m = float(depth(u, v)) * 1e-3F;
    point.at = camera.point(float(u), float(v), z_m);
    add_parts(posteriors.at(u - of.u, v - of.v), parts, point);
    if (point.part.front() == kBackground) {
      point.part.front() = part;
      point.share.front() = 1.F;
    }
  });
  return points;
}

}  // namespace vesalius
