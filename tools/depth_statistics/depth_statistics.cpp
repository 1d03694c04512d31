#include "depth_statistics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

namespace vesalius {
namespace {

constexpr int kRadius = 3;                    // of the plane windows: 7 x 7
constexpr int kStride = 5;                    // between windows
constexpr float kNear_m = 0.15F;              // a window counts for a distance this close to it
constexpr double kEdge = 0.05, kStep = 0.10;  // of the distance
constexpr int kWidestHole_px = 60;            // wider ones are no shadow

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double ratio(std::int64_t a, std::int64_t b) {
  return b == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(a) / static_cast<double>(b);
}

bool differs(std::uint16_t a, std::uint16_t b, double share) {
  return a != 0 && b != 0 && std::abs(a - b) > share * std::min(a, b);
}

std::optional<std::size_t> distance_bin(float depth_m) {
  for (std::size_t i = 0; i < kDistances_m.size(); ++i) {
    if (std::abs(depth_m - kDistances_m[i]) < kNear_m) return i;
  }
  return std::nullopt;
}

/// RMS residual of a plane fitted to a full window in disparity space, where planes stay planes; nothing for windows
/// with holes or steps.
std::optional<float> plane_residual_mm(const DepthImage& depth, int u, int v) {
  constexpr int kPoints = (2 * kRadius + 1) * (2 * kRadius + 1);
  Eigen::Matrix<double, kPoints, 3> positions;
  Eigen::Matrix<double, kPoints, 1> inverse;
  const std::uint16_t centre = depth(u, v);
  int i = 0;
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    for (int du = -kRadius; du <= kRadius; ++du, ++i) {
      const std::uint16_t here = depth(u + du, v + dv);
      if (here == 0 || differs(here, centre, kEdge / 2)) return std::nullopt;
      positions.row(i) << du, dv, 1.0;
      inverse(i) = 1.0 / here;
    }
  }
  const Eigen::Vector3d plane = (positions.transpose() * positions).ldlt().solve(positions.transpose() * inverse);
  const double rms = std::sqrt((inverse - positions * plane).squaredNorm() / (kPoints - 3));
  return static_cast<float>(rms * centre * centre);
}

bool column_empty(const DepthImage& depth, int u) {
  for (int v = 0; v < depth.height(); ++v) {
    if (depth(u, v) != 0) return false;
  }
  return true;
}

int empty_border(const DepthImage& depth) {
  int left = 0, right = 0;
  while (left < depth.width() && column_empty(depth, left)) ++left;
  while (right < depth.width() - left && column_empty(depth, depth.width() - 1 - right)) ++right;
  return left + right;
}

/// Median distance of neighbouring values near `depth_mm` that occur often enough to be no accident.
double step_at(const std::vector<std::int64_t>& seen, int depth_mm) {
  std::vector<double> steps;
  int last = 0;
  for (int z = depth_mm - 200; z <= depth_mm + 200; ++z) {
    if (seen[z] == 0) continue;
    if (last > 0) steps.push_back(z - last);
    last = z;
  }
  return median(std::move(steps));
}

}  // namespace

void DepthStatistics::add(const DepthImage& depth) {
  ++frames_;
  pixels_ += static_cast<std::int64_t>(depth.size());
  border_ += empty_border(depth);
  for (const std::uint16_t z : depth) {
    ++seen_[z];
    holes_ += z == 0;
  }
  add_rows(depth);
  add_planes(depth);
}

void DepthStatistics::add_rows(const DepthImage& depth) {
  for (int v = 0; v < depth.height(); ++v) {
    int last = -1;  // column of the last reading
    for (int u = 0; u < depth.width(); ++u) {
      const std::uint16_t here = depth(u, v);
      if (here == 0) continue;
      ++readings_;
      const auto edge_to = [&](int du, int dv) {
        return depth.contains(u + du, v + dv) && differs(here, depth(u + du, v + dv), kEdge);
      };
      edges_ += edge_to(-1, 0) || edge_to(1, 0) || edge_to(0, -1) || edge_to(0, 1);
      if (last >= 0 && u - last - 1 <= kWidestHole_px && differs(here, depth(last, v), kStep)) {
        ++steps_;
        if (u - last > 1) step_holes_px_.push_back(u - last - 1);
      }
      last = u;
    }
  }
}

void DepthStatistics::add_planes(const DepthImage& depth) {
  for (int v = kRadius; v + kRadius < depth.height(); v += kStride) {
    for (int u = kRadius; u + kRadius < depth.width(); u += kStride) {
      const auto bin = distance_bin(static_cast<float>(depth(u, v)) * 1e-3F);
      if (!bin) continue;
      if (const auto residual = plane_residual_mm(depth, u, v)) residuals_mm_[*bin].push_back(*residual);
    }
  }
}

DepthFigures DepthStatistics::figures() const {
  DepthFigures f;
  f.holes = ratio(holes_, pixels_);
  f.border_px = ratio(border_, frames_);
  f.edge_pixels = ratio(edges_, readings_);
  f.holes_at_steps = ratio(static_cast<std::int64_t>(step_holes_px_.size()), steps_);
  f.hole_width_px = median({step_holes_px_.begin(), step_holes_px_.end()});
  for (std::size_t i = 0; i < kDistances_m.size(); ++i) {
    f.noise_mm[i] = median({residuals_mm_[i].begin(), residuals_mm_[i].end()});
    f.step_mm[i] = step_at(seen_, static_cast<int>(std::lround(kDistances_m[i] * 1000.F)));
  }
  return f;
}

}  // namespace vesalius
