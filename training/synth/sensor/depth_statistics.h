#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "synth/sensor/sensor.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// Distances at which noise, steps and holes are measured, metres.
inline constexpr std::array<float, 4> kDistances_m = {1.F, 2.F, 3.F, 4.F};

/// What tells one depth sensor's pictures from another's, whatever they show. NaN where nothing was measured.
struct DepthFigures {
  double holes = 0.0;                 ///< share of pixels without reading
  std::array<double, 4> border_px{};  ///< mean number of empty columns and rows: left, right, top, bottom
  double edge_pixels = 0.0;           ///< share of readings with a 4-neighbour more than 5 % farther or nearer
  double holes_at_steps = 0.0;        ///< share of steps along a row, over 10 % of the distance, with a hole in between
  double hole_width_px = 0.0;         ///< median width of those holes
  double ramp_px = 0.0;  ///< mean number of readings between near and far side of steps without a hole, at most 12
  double rims_drawn_in = 0.0;  ///< share of readings beside holes that are 4 to 60 % nearer than the two behind them
  /// Share of holes on surfaces: pixels of a row between two readings that differ by less than 10 %.
  std::array<double, kDistances_m.size()> surface_holes{};
  std::array<double, kDistances_m.size()> noise_mm{};  ///< median residual (RMS) to planes fitted in 7 x 7 pixels
  std::array<double, kDistances_m.size()> step_mm{};   ///< median distance of neighbouring depth values that occur
};

/// Gathers figures over frames of one sensor.
class DepthStatistics {
 public:
  void add(const DepthImage& depth);
  /// Adds what another one gathered.
  void add(const DepthStatistics& other);
  DepthFigures figures() const;

 private:
  void add_rows(const DepthImage& depth);
  void add_ramps(const DepthImage& depth);
  void add_planes(const DepthImage& depth);

  std::int64_t pixels_ = 0, holes_ = 0, readings_ = 0, edges_ = 0, frames_ = 0, steps_ = 0;
  std::int64_t ramps_ = 0, ramp_pixels_ = 0, rims_ = 0, rims_drawn_in_ = 0;
  std::array<std::int64_t, 4> border_{};
  std::array<std::int64_t, kDistances_m.size()> surface_{}, surface_holes_{};
  std::vector<int> step_holes_px_;
  std::array<std::vector<float>, kDistances_m.size()> residuals_mm_;
  std::vector<std::int64_t> seen_ = std::vector<std::int64_t>(65536, 0);  ///< how often each depth value occurs
};

}  // namespace vesalius::synth
