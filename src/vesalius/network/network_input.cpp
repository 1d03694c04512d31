#include "vesalius/network/network_input.h"

#include <algorithm>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kAcross = 2;        ///< pixels to either side by which slopes are measured
constexpr float kSteepest = 3.F;  ///< of slopes

/// Rounds down, so that it is the same everywhere; x is above -1024.
int rounded_down(float x) { return int(x + 1024.F) - 1024; }

std::uint8_t channel(int steps) { return static_cast<std::uint8_t>(std::clamp(kNetworkZero + steps, 0, 255)); }

/// Returns the slope between two readings, whose steps from one to the other are `steps_per_mm` each.
std::uint8_t slope(int before_mm, int after_mm, float steps_per_mm) {
  if (before_mm == 0 || after_mm == 0) return kNetworkZero;
  constexpr float most = kSteepest * kNetworkSteps;
  const float steps = std::clamp(float(after_mm - before_mm) * steps_per_mm, -most, most);
  return channel(rounded_down(steps + 0.5F));
}

/// Writes one row: the picture's row `v`, or what stands for rows beyond it.
void fill_row(const DepthImage& depth, float focal_px, int v, int width, std::uint8_t* to) {
  std::fill_n(to, static_cast<std::size_t>(width) * kNetworkInputs, static_cast<std::uint8_t>(kNetworkZero));
  if (v >= depth.height()) return;
  const std::uint16_t* row = depth.row(v);
  const bool has_rows = v >= kAcross && v + kAcross < depth.height();
  const std::uint16_t* above = has_rows ? depth.row(v - kAcross) : nullptr;
  const std::uint16_t* below = has_rows ? depth.row(v + kAcross) : nullptr;
  const float near = kNetworkSteps * kNearFiner * 2000.F / 285.F * focal_px;
  constexpr float usual = 0.7F * kNetworkSteps * kNearFiner;
  const float steep = kNetworkSteps / float(2 * kAcross) * focal_px;
  for (int u = 0; u < depth.width(); ++u, to += kNetworkInputs) {
    if (row[u] == 0) continue;
    const float inverse = 1.F / float(row[u]);
    const int fine = rounded_down(std::min(near * inverse, 32000.F) - usual + 0.5F);
    const int coarse = rounded_down((float(fine) + 0.5F * kNearFiner) / float(kNearFiner));
    to[0] = channel(coarse);
    to[1] = channel(fine - kNearFiner * coarse);
    to[2] = channel(int(kNetworkSteps));
    const float per_mm = steep * inverse;
    if (u >= kAcross && u + kAcross < depth.width()) to[3] = slope(row[u - kAcross], row[u + kAcross], per_mm);
    if (has_rows) to[4] = slope(above[u], below[u], per_mm);
  }
}

int padded(int size) { return (size + kNetworkMultiple - 1) / kNetworkMultiple * kNetworkMultiple; }

}  // namespace

void fill_network_input(const DepthImage& depth, float focal_px, NetworkInput& input) {
  input.width = padded(depth.width());
  input.height = padded(depth.height());
  const std::size_t row = static_cast<std::size_t>(input.width) * kNetworkInputs;
  input.values.resize(row * static_cast<std::size_t>(input.height));
  parallel_ranges(input.height, kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) fill_row(depth, focal_px, v, input.width, input.values.data() + v * row);
  });
}

}  // namespace vesalius
