#include "synth/sensor/depth_statistics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <optional>

namespace vesalius::synth {
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

/// Returns how many columns or rows have no reading, from the first or from the last one on.
int empty_lines(const DepthImage& depth, bool columns, bool from_last) {
  const int lines = columns ? depth.width() : depth.height(), across = columns ? depth.height() : depth.width();
  const auto empty = [&](int line) {
    const int at = from_last ? lines - 1 - line : line;
    for (int i = 0; i < across; ++i) {
      if ((columns ? depth(at, i) : depth(i, at)) != 0) return false;
    }
    return true;
  };
  int count = 0;
  while (count < lines && empty(count)) ++count;
  return count;
}

/// Returns how much farther (above 0) or nearer `b` is than `a`, as a share of the nearer one.
double change(std::uint16_t a, std::uint16_t b) { return double(int(b) - int(a)) / double(std::min(a, b)); }

/// Returns whether the reading at `u`, beside a hole at `u - step`, was drawn towards the hole: it is nearer than the
/// two behind it, which agree.
bool drawn_in(const std::uint16_t* row, int u, int step) {
  const std::uint16_t rim = row[u], next = row[u + step], behind = row[u + 2 * step];
  if (next == 0 || behind == 0) return false;
  const double agree = std::abs(change(next, behind)), nearer = 1.0 - double(rim) / double(behind);
  return agree < 0.02 && nearer > 0.04 && nearer < 0.6;
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
  const std::array<int, 4> border = {empty_lines(depth, true, false), empty_lines(depth, true, true),
                                     empty_lines(depth, false, false), empty_lines(depth, false, true)};
  for (std::size_t i = 0; i < border.size(); ++i) border_[i] += border[i];
  for (const std::uint16_t z : depth) {
    ++seen_[z];
    holes_ += z == 0;
  }
  add_rows(depth);
  add_ramps(depth);
  add_planes(depth);
}

void DepthStatistics::add(const DepthStatistics& other) {
  const auto plus = [](auto& mine, const auto& others) {
    std::transform(mine.begin(), mine.end(), others.begin(), mine.begin(), std::plus<>());
  };
  for (const auto member :
       {&DepthStatistics::pixels_, &DepthStatistics::holes_, &DepthStatistics::readings_, &DepthStatistics::edges_,
        &DepthStatistics::frames_, &DepthStatistics::steps_, &DepthStatistics::ramps_, &DepthStatistics::ramp_pixels_,
        &DepthStatistics::rims_, &DepthStatistics::rims_drawn_in_}) {
    this->*member += other.*member;
  }
  plus(border_, other.border_);
  plus(surface_, other.surface_);
  plus(surface_holes_, other.surface_holes_);
  plus(seen_, other.seen_);
  step_holes_px_.insert(step_holes_px_.end(), other.step_holes_px_.begin(), other.step_holes_px_.end());
  for (std::size_t i = 0; i < residuals_mm_.size(); ++i) {
    residuals_mm_[i].insert(residuals_mm_[i].end(), other.residuals_mm_[i].begin(), other.residuals_mm_[i].end());
  }
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
      if (last >= 0 && u - last - 1 <= kWidestHole_px) {
        const int hole = u - last - 1;
        if (differs(here, depth(last, v), kStep)) {
          ++steps_;
          if (hole > 0) step_holes_px_.push_back(hole);
        } else if (const auto bin = distance_bin(float(here) * 1e-3F)) {
          surface_[*bin] += hole + 1;
          surface_holes_[*bin] += hole;
        }
      }
      last = u;
    }
  }
}

/// Counts the readings in which depth changes by more than 2 % from each to the next in one direction, over 10 % in
/// all.
void DepthStatistics::add_ramps(const DepthImage& depth) {
  constexpr double kRises = 0.02;
  constexpr int kLongest_px = 12;
  for (int v = 0; v < depth.height(); ++v) {
    const std::uint16_t* row = depth.row(v);
    for (int u = 1; u < depth.width(); ++u) {
      const bool after_hole = row[u - 1] == 0 && row[u] != 0, before_hole = row[u - 1] != 0 && row[u] == 0;
      if (after_hole && u > 1 && u + 2 < depth.width()) {
        ++rims_;
        rims_drawn_in_ += drawn_in(row, u, 1) ? 1 : 0;
      }
      if (before_hole && u >= 3) {
        ++rims_;
        rims_drawn_in_ += drawn_in(row, u - 1, -1) ? 1 : 0;
      }
      if (row[u - 1] == 0 || row[u] == 0) continue;
      const double first = change(row[u - 1], row[u]);
      if (std::abs(first) < kRises) continue;
      int end = u;
      while (end + 1 < depth.width() && row[end + 1] != 0 && change(row[end], row[end + 1]) * first > 0.0 &&
             std::abs(change(row[end], row[end + 1])) >= kRises) {
        ++end;
      }
      if (differs(row[u - 1], row[end], kStep) && end - u <= kLongest_px) {
        ++ramps_;
        ramp_pixels_ += end - u;
      }
      u = end;
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
  for (std::size_t i = 0; i < border_.size(); ++i) f.border_px[i] = ratio(border_[i], frames_);
  f.edge_pixels = ratio(edges_, readings_);
  f.holes_at_steps = ratio(static_cast<std::int64_t>(step_holes_px_.size()), steps_);
  f.ramp_px = ratio(ramp_pixels_, ramps_);
  f.rims_drawn_in = ratio(rims_drawn_in_, rims_);
  f.hole_width_px = median({step_holes_px_.begin(), step_holes_px_.end()});
  for (std::size_t i = 0; i < kDistances_m.size(); ++i) {
    f.surface_holes[i] = ratio(surface_holes_[i], surface_[i]);
    f.noise_mm[i] = median({residuals_mm_[i].begin(), residuals_mm_[i].end()});
    f.step_mm[i] = step_at(seen_, static_cast<int>(std::lround(kDistances_m[i] * 1000.F)));
  }
  return f;
}

}  // namespace vesalius::synth
