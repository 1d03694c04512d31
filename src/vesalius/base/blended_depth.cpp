#include "vesalius/base/blended_depth.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kBlendRows = 16;
constexpr int kWidest = 3;  ///< pixels of a ramp: as far as cubic interpolation reaches, and a pixel more
constexpr std::array<std::array<int, 2>, 8> kAround{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

struct Pixel {
  int u = 0, v = 0;
};

/// Appends the readings around a hole that were blended with it.
void add_blended(const DepthImage& depth, Pixel hole, float least_share, std::vector<Pixel>& blended) {
  const bool inner = depth.contains(hole.u - 2, hole.v - 2) && depth.contains(hole.u + 2, hole.v + 2);
  const std::uint16_t* at = depth.row(hole.v) + hole.u;
  for (const auto& [du, dv] : kAround) {
    if (!inner && !depth.contains(hole.u + 2 * du, hole.v + 2 * dv)) continue;
    const std::ptrdiff_t step = std::ptrdiff_t{dv} * depth.width() + du;
    const int near = at[step], far = at[2 * step];
    if (near != 0 && float(near) < least_share * float(far)) blended.push_back({hole.u + du, hole.v + dv});
  }
}

/// Memory for a row of a picture.
struct BlendRow {
  explicit BlendRow(int width) : any(static_cast<std::size_t>(width) + 2), holes(static_cast<std::size_t>(width)) {}
  std::vector<std::uint16_t> any;   ///< readings of three rows, one pixel to the right
  std::vector<std::uint8_t> holes;  ///< 1 on holes that have a reading beside them
};

/// Finds the holes of a row that have a reading beside them. Most holes are inside larger ones.
void find_holes(const DepthImage& depth, int v, BlendRow& row) {
  const int width = depth.width();
  const std::uint16_t* here = depth.row(v);
  const std::uint16_t *above = depth.row(std::max(0, v - 1)), *below = depth.row(std::min(depth.height() - 1, v + 1));
  for (int u = 0; u < width; ++u) row.any[u + 1] = static_cast<std::uint16_t>(above[u] | here[u] | below[u]);
  for (int u = 0; u < width; ++u) {
    const bool beside = (row.any[u] | row.any[u + 1] | row.any[u + 2]) != 0;
    row.holes[u] = static_cast<std::uint8_t>(int(here[u] == 0) & int(beside));
  }
}

/// Returns the blended readings beside all holes of a picture.
std::vector<Pixel> blended_beside_holes(const DepthImage& depth, float least_share) {
  std::vector<std::vector<Pixel>> of_row(depth.height());
  parallel_ranges(depth.height(), kBlendRows, [&](int begin, int end) {
    BlendRow row(depth.width());
    for (int v = begin; v < end; ++v) {
      find_holes(depth, v, row);
      const std::uint8_t *first = row.holes.data(), *last = first + row.holes.size(), *hole = first;
      const auto next = [&] {
        hole = static_cast<const std::uint8_t*>(std::memchr(hole, 1, static_cast<std::size_t>(last - hole)));
        return hole != nullptr;
      };
      for (; hole != last && next(); ++hole) add_blended(depth, {int(hole - first), v}, least_share, of_row[v]);
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

}  // namespace vesalius
