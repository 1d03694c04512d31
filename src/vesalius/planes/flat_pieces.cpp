#include "vesalius/planes/flat_pieces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

namespace vesalius {
namespace {

constexpr int kPieceGapMm = 30;  // depth step within a connected piece, plus a share of the farther depth
constexpr int kPieceGapShare = 50;

/// Whether two neighbours are in one piece, whichever of them one comes from: the farther is the less certain reading.
bool connected(int a_mm, int b_mm) {
  return std::abs(a_mm - b_mm) <= kPieceGapMm + std::max(a_mm, b_mm) / kPieceGapShare;
}

/// Flat pixels next to each other in a row that are connected.
struct Run {
  int v = 0, begin = 0, end = 0;
  std::size_t piece = 0;  ///< index of an earlier run of the same piece; its own for the piece's first
  std::uint64_t squares_mm2 = 0;
};

std::size_t first_of(std::vector<Run>& runs, std::size_t run) {
  while (runs[run].piece != run) run = runs[run].piece = runs[runs[run].piece].piece;
  return run;
}

void add_runs(const DepthImage& depth, const Mask& flat, int v, std::vector<Run>& runs) {
  const std::uint16_t* mm = depth.row(v);
  const std::uint8_t* is_flat = flat.row(v);
  for (int u = 0; u < flat.width();) {
    if (is_flat[u] == 0) {
      ++u;
      continue;
    }
    Run run{v, u, u, runs.size(), 0};
    do {
      run.squares_mm2 += static_cast<std::uint64_t>(mm[u]) * mm[u];
      ++u;
    } while (u < flat.width() && is_flat[u] != 0 && connected(mm[u - 1], mm[u]));
    run.end = u;
    runs.push_back(run);
  }
}

/// Joins the runs from `above` to `below` - 1, which are a row, with those from `below` on, which are the next one.
void join_rows(const DepthImage& depth, std::size_t above, std::size_t below, std::vector<Run>& runs) {
  const std::size_t end = below;
  while (above < end && below < runs.size()) {
    const Run &high = runs[above], &low = runs[below];
    const std::uint16_t *high_mm = depth.row(high.v), *low_mm = depth.row(low.v);
    const int last = std::min(high.end, low.end);
    int u = std::max(high.begin, low.begin);
    while (u < last && !connected(high_mm[u], low_mm[u])) ++u;
    if (u < last) {
      const std::size_t a = first_of(runs, above), b = first_of(runs, below);
      runs[std::max(a, b)].piece = std::min(a, b);
    }
    (high.end < low.end ? above : below) += 1;
  }
}

/// All runs, row by row, each with the first run of its piece.
std::vector<Run> find_runs(const DepthImage& depth, const Mask& flat) {
  std::vector<Run> runs;
  std::size_t above = 0;
  for (int v = 0; v < flat.height(); ++v) {
    const std::size_t below = runs.size();
    add_runs(depth, flat, v, runs);
    join_rows(depth, above, below, runs);
    above = below;
  }
  for (std::size_t r = 0; r < runs.size(); ++r) runs[r].piece = first_of(runs, r);
  return runs;
}

/// Row-major pixels of each piece whose squared depths add up to less than `surely_large_mm2`.
std::vector<std::vector<int>> small_pieces(const DepthImage& depth, const Mask& flat, double surely_large_mm2) {
  const std::vector<Run> runs = find_runs(depth, flat);
  std::vector<std::uint64_t> squares_mm2(runs.size(), 0);
  for (const Run& run : runs) squares_mm2[run.piece] += run.squares_mm2;
  std::vector<std::vector<int>> pieces(runs.size());
  for (const Run& run : runs) {
    if (double(squares_mm2[run.piece]) >= surely_large_mm2) continue;
    for (int u = run.begin; u < run.end; ++u) pieces[run.piece].push_back(run.v * flat.width() + u);
  }
  std::erase_if(pieces, [](const std::vector<int>& pixels) { return pixels.empty(); });
  return pieces;
}

/// Of the outline of those pixels, whether most is not due to something nearer in front.
bool ends_by_itself(const DepthImage& depth, const Mask& flat, const std::vector<int>& pixels) {
  constexpr std::array<std::array<int, 2>, 4> kSides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  constexpr int kBeyond = 3;  // pixels past the outline: single noisy ones do not count
  constexpr int kRim = 10;    // pixels looked through for one with a reading
  long hidden = 0;
  long unhidden = 0;
  for (const int pixel : pixels) {
    const int u = pixel % flat.width(), v = pixel / flat.width();
    for (const auto& [du, dv] : kSides) {
      if (!flat.contains(u + du, v + dv) || flat(u + du, v + dv) != 0) continue;
      int beyond = 0;
      for (int k = kBeyond; k <= kRim && beyond == 0 && flat.contains(u + k * du, v + k * dv); ++k) {
        if (flat(u + k * du, v + k * dv) != 0) break;  // a noisy pixel, no end
        beyond = depth(u + k * du, v + k * dv);
      }
      if (beyond == 0) continue;
      (beyond < depth(u, v) && !connected(beyond, depth(u, v)) ? hidden : unhidden) += 1;
    }
  }
  return unhidden > hidden;
}

}  // namespace

Mask without_body_pieces(const DepthImage& depth, const Mask& flat, double surely_large_mm2,
                         const std::function<bool(const std::vector<int>&)>& large) {
  Mask out = flat;
  for (const std::vector<int>& pixels : small_pieces(depth, flat, surely_large_mm2)) {
    if (large(pixels) || !ends_by_itself(depth, flat, pixels)) continue;
    for (const int pixel : pixels) out[pixel] = 0;
  }
  return out;
}

}  // namespace vesalius
