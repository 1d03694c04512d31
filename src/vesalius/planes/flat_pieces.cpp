#include "vesalius/planes/flat_pieces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

namespace vesalius {
namespace {

constexpr int kPieceGapMm = 30;  // depth step within a connected piece, plus a share of the depth
constexpr int kPieceGapShare = 50;

/// Largest step in depth from a pixel to a neighbour in the same piece. It depends on where one comes from: at the
/// limit pixels may be connected one way only.
int largest_step(int depth_mm) { return kPieceGapMm + depth_mm / kPieceGapShare; }

/// What pixels in a row are connected with each other both ways, and the larger sets that such runs make up.
class Runs {
 public:
  struct Run {
    int v = 0, begin = 0, end = 0;
    std::size_t set = 0;  ///< a run of the same set; itself for the set's first
    std::uint64_t squares_mm2 = 0;
  };

  Runs(const DepthImage& depth, const Mask& flat) : depth_(depth), flat_(flat) {
    std::size_t above = 0;
    for (int v = 0; v < flat.height(); ++v) {
      const std::size_t first = runs_.size();
      find_in_row(v);
      join_rows(above, first);
      above = first;
    }
  }

  /// Everything that can be reached from one of its pixels, in the order of first pixels, but for what an earlier piece
  /// has: the runs of each piece.
  std::vector<std::vector<Run>> pieces() {
    std::vector<std::vector<std::size_t>> runs_of(runs_.size()), ways(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) runs_of[set_of(r)].push_back(r);
    for (const auto& [from, to] : one_way_) ways[set_of(from)].push_back(set_of(to));
    std::vector<char> seen(runs_.size(), 0);
    std::vector<std::vector<Run>> all;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (set_of(r) != r || seen[r] != 0) continue;
      std::vector<Run>& piece = all.emplace_back();
      std::vector<std::size_t> open{r};
      seen[r] = 1;
      for (std::size_t head = 0; head < open.size(); ++head) {
        for (const std::size_t member : runs_of[open[head]]) piece.push_back(runs_[member]);
        for (const std::size_t next : ways[open[head]]) {
          if (seen[next] == 0) open.push_back(next);
          seen[next] = 1;
        }
      }
    }
    return all;
  }

 private:
  void find_in_row(int v) {
    const std::uint16_t* depth = depth_.row(v);
    const std::uint8_t* flat = flat_.row(v);
    bool open = false;
    for (int u = 0; u < flat_.width(); ++u) {
      if (flat[u] == 0) {
        open = false;
        continue;
      }
      const int step = open ? std::abs(depth[u] - depth[u - 1]) : 0;
      const bool forth = open && step <= largest_step(depth[u - 1]), back = open && step <= largest_step(depth[u]);
      if (!forth || !back) {
        runs_.push_back({v, u, u, runs_.size(), 0});
        if (forth) one_way_.emplace_back(runs_.size() - 2, runs_.size() - 1);
        if (back) one_way_.emplace_back(runs_.size() - 1, runs_.size() - 2);
        open = true;
      }
      Run& run = runs_.back();
      run.end = u + 1;
      run.squares_mm2 += static_cast<std::uint64_t>(depth[u]) * depth[u];
    }
  }

  /// Runs from `above` to `first` - 1 are a row, those from `first` the next one.
  void join_rows(std::size_t above, std::size_t first) {
    std::size_t a = above, b = first;
    while (a < first && b < runs_.size() && runs_[b].v == runs_[a].v + 1) {
      join(a, b);
      (runs_[a].end < runs_[b].end ? a : b) += 1;
    }
  }

  void join(std::size_t above, std::size_t below) {
    const int begin = std::max(runs_[above].begin, runs_[below].begin);
    const int end = std::min(runs_[above].end, runs_[below].end);
    const std::uint16_t* high = depth_.row(runs_[above].v);
    const std::uint16_t* low = depth_.row(runs_[below].v);
    bool down = false, up = false;
    for (int u = begin; u < end && !(down && up); ++u) {
      const int step = std::abs(high[u] - low[u]);
      down = down || step <= largest_step(high[u]);
      up = up || step <= largest_step(low[u]);
    }
    if (down && up) {
      const std::size_t x = set_of(above), y = set_of(below);
      runs_[std::max(x, y)].set = std::min(x, y);
    } else if (down) {
      one_way_.emplace_back(above, below);
    } else if (up) {
      one_way_.emplace_back(below, above);
    }
  }

  std::size_t set_of(std::size_t run) {
    while (runs_[run].set != run) run = runs_[run].set = runs_[runs_[run].set].set;
    return run;
  }

  const DepthImage& depth_;
  const Mask& flat_;
  std::vector<Run> runs_;
  std::vector<std::pair<std::size_t, std::size_t>> one_way_;  ///< runs, from and to
};

/// Looks at one piece after the other, pixel by pixel.
class PieceFilter {
 public:
  PieceFilter(const DepthImage& depth, const Mask& flat)
      : depth_(depth), flat_(flat), open_(flat.width(), flat.height(), 0) {}

  /// The runs' pixels in order of breadth-first search from the first.
  const std::vector<int>& pixels(const std::vector<Runs::Run>& piece) {
    for (const Runs::Run& run : piece) std::fill(open_.row(run.v) + run.begin, open_.row(run.v) + run.end, 1);
    const int first = piece.front().v * flat_.width() + piece.front().begin;
    pixels_.assign(1, first);
    open_[first] = 0;
    for (std::size_t head = 0; head < pixels_.size(); ++head) {
      const int u = pixels_[head] % flat_.width(), v = pixels_[head] / flat_.width();
      for (const auto& [du, dv] : kSides) {
        const int nu = u + du, nv = v + dv;
        if (!flat_.contains(nu, nv) || open_(nu, nv) == 0) continue;
        if (std::abs(depth_(nu, nv) - depth_(u, v)) > largest_step(depth_(u, v))) continue;
        open_(nu, nv) = 0;
        pixels_.push_back(nv * flat_.width() + nu);
      }
    }
    return pixels_;
  }

  /// Of the outline of those pixels, whether most is not due to something nearer in front.
  bool ends_by_itself() const {
    long hidden = 0;
    long unhidden = 0;
    for (const int pixel : pixels_) {
      const int u = pixel % flat_.width(), v = pixel / flat_.width();
      for (const auto& [du, dv] : kSides) {
        if (!flat_.contains(u + du, v + dv) || flat_(u + du, v + dv) != 0) continue;
        int beyond = 0;
        for (int k = kBeyond; k <= kRim && beyond == 0 && flat_.contains(u + k * du, v + k * dv); ++k) {
          if (flat_(u + k * du, v + k * dv) != 0) break;  // a noisy pixel, no end
          beyond = depth_(u + k * du, v + k * dv);
        }
        if (beyond == 0) continue;
        (beyond < depth_(u, v) - largest_step(depth_(u, v)) ? hidden : unhidden) += 1;
      }
    }
    const float share = static_cast<float>(unhidden) / static_cast<float>(hidden + unhidden);
    return hidden + unhidden > 0 && share > kMostUnhidden;
  }

 private:
  static constexpr std::array<std::array<int, 2>, 4> kSides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  static constexpr float kMostUnhidden = 0.5F;  // share of the outline
  static constexpr int kBeyond = 3;             // pixels past the outline: single noisy ones do not count
  static constexpr int kRim = 10;               // pixels looked through for one with a reading

  const DepthImage& depth_;
  const Mask& flat_;
  Mask open_;  ///< pixels of the piece that were not met yet
  std::vector<int> pixels_;
};

}  // namespace

Mask without_body_pieces(const DepthImage& depth, const Mask& flat, double surely_large_mm2,
                         const std::function<bool(const std::vector<int>&)>& large) {
  Mask out = flat;
  PieceFilter filter(depth, flat);
  for (const std::vector<Runs::Run>& piece : Runs(depth, flat).pieces()) {
    std::uint64_t squares_mm2 = 0;
    for (const Runs::Run& run : piece) squares_mm2 += run.squares_mm2;
    if (static_cast<double>(squares_mm2) >= surely_large_mm2) continue;
    const std::vector<int>& pixels = filter.pixels(piece);
    if (large(pixels) || !filter.ends_by_itself()) continue;
    for (const int pixel : pixels) out[pixel] = 0;
  }
  return out;
}

}  // namespace vesalius
