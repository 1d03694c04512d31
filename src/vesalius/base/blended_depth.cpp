#include "vesalius/base/blended_depth.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kBlendRows = 16;
constexpr int kWidest = 3;  ///< pixels of a ramp: as far as cubic interpolation reaches, and a pixel more
constexpr std::array<std::array<int, 2>, 8> kSides{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

struct Pixel {
  int u = 0, v = 0;
};

/// Appends the readings around a hole that were blended with it.
void add_blended(const DepthImage& depth, Pixel hole, float least_share, std::vector<Pixel>& blended) {
  for (const auto& [du, dv] : kSides) {
    const Pixel beside{hole.u + du, hole.v + dv}, behind{hole.u + 2 * du, hole.v + 2 * dv};
    if (!depth.contains(behind.u, behind.v)) continue;
    const int near = depth(beside.u, beside.v), far = depth(behind.u, behind.v);
    if (near != 0 && float(near) < least_share * float(far)) blended.push_back(beside);
  }
}

/// Returns for each pixel of a row 1 if it is a hole and has a reading beside it. Most holes are inside larger ones.
std::vector<std::uint8_t> holes_beside_readings(const DepthImage& depth, int v) {
  const int width = depth.width();
  std::vector<std::uint16_t> any(static_cast<std::size_t>(width) + 2,
                                 0);  // readings of the rows, one pixel to the right
  for (int row = std::max(0, v - 1); row <= std::min(depth.height() - 1, v + 1); ++row) {
    const std::uint16_t* values = depth.row(row);
    for (int u = 0; u < width; ++u) any[u + 1] = static_cast<std::uint16_t>(any[u + 1] | values[u]);
  }
  const std::uint16_t* here = depth.row(v);
  std::vector<std::uint8_t> holes(width);
  for (int u = 0; u < width; ++u) holes[u] = here[u] == 0 && (any[u] | any[u + 1] | any[u + 2]) != 0 ? 1 : 0;
  return holes;
}

/// Returns the blended readings beside all holes of a picture.
std::vector<Pixel> blended_beside_holes(const DepthImage& depth, float least_share) {
  std::vector<std::vector<Pixel>> of_row(depth.height());
  parallel_ranges(depth.height(), kBlendRows, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      const std::vector<std::uint8_t> holes = holes_beside_readings(depth, v);
      for (int u = 0; u < depth.width(); ++u) {
        if (holes[u] != 0) add_blended(depth, {u, v}, least_share, of_row[v]);
      }
    }
  });
  std::vector<Pixel> all;
  for (const std::vector<Pixel>& pixels : of_row) all.insert(all.end(), pixels.begin(), pixels.end());
  return all;
}

}  // namespace

std::optional<DepthImage> without_blended(const DepthImage& depth, const BlendOptions& options) {
  std::vector<Pixel> blended = blended_beside_holes(depth, options.least_share);
  if (blended.empty()) return std::nullopt;
  DepthImage out = depth;
  for (int width = 1;; ++width) {
    for (const Pixel& pixel : blended) out(pixel.u, pixel.v) = 0;
    if (width == kWidest) return out;
    std::vector<Pixel> next;
    for (const Pixel& pixel : blended) add_blended(out, pixel, options.least_share, next);
    blended = std::move(next);
  }
}

const Frame& without_blended(const Frame& frame, const BlendOptions& options, Frame& memory) {
  std::optional<DepthImage> depth = without_blended(frame.depth, options);
  if (!depth) return frame;
  memory = {frame.name, frame.time_s, frame.camera, std::move(*depth), frame.colour};
  return memory;
}

}  // namespace vesalius
