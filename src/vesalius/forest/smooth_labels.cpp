#include "vesalius/forest/smooth_labels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/forest/mean_kernel.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Tells whether all pixels of a window have one label, whatever their depth. Most of a picture then needs no counting.
class EvenWindows {
 public:
  /// Prepares for windows around the pixels of rows `begin` to `end` - 1.
  EvenWindows(const LabelImage& labels, int window, int begin, int end)
      : labels_(labels),
        reach_(window / 2),
        first_row_(std::max(0, begin - reach_)),
        run_(labels.width(), std::min(labels.height(), end + reach_) - first_row_) {
    for (int v = 0; v < run_.height(); ++v) {
      const std::uint8_t* row = labels.row(first_row_ + v);
      std::uint8_t* run = run_.row(v);
      for (int u = 0; u < labels.width(); ++u) {
        const bool goes_on = u > 0 && row[u] == row[u - 1];
        run[u] = goes_on ? static_cast<std::uint8_t>(std::min(run[u - 1] + 1, 255)) : std::uint8_t{1};
      }
    }
  }

  bool operator()(int u, int v) const {
    if (u < reach_ || v < reach_ || u + reach_ >= labels_.width() || v + reach_ >= labels_.height()) return false;
    for (int nv = v - reach_; nv <= v + reach_; ++nv) {
      if (run_(u + reach_, nv - first_row_) <= 2 * reach_ || labels_(u, nv) != labels_(u, v)) return false;
    }
    return true;
  }

 private:
  const LabelImage& labels_;
  int reach_;
  int first_row_;
  Image<std::uint8_t> run_;  ///< equal labels in a row that end here, at most 255
};

/// Does mean_filter without the lowest bits of all sums.
void coarse_mean(const Posteriors& posteriors, const DepthImage& depth, const SmoothWindow& window, int bits,
                 Posteriors& out) {
  Posteriors coarse = posteriors;
  for (std::uint16_t& sum : coarse.sums) sum = static_cast<std::uint16_t>(sum >> bits);
  parallel_ranges(posteriors.height, kRowGrain, [&](int begin, int end) {
    mean_rows(coarse, depth, window, begin, end, out);
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < out.width; ++u) {
        std::uint16_t* mean = out.at(u, v);
        const bool settled = !posteriors.settled.empty() && posteriors.settled(u, v) != 0;
        const std::uint16_t* exact = posteriors.at(u, v);
        for (int c = 0; c < out.classes; ++c)
          mean[c] = settled ? exact[c] : static_cast<std::uint16_t>(mean[c] << bits);
      }
    }
  });
}

}  // namespace

LabelImage mode_filter(const LabelImage& labels, const DepthImage& depth, const SmoothOptions& options) {
  LabelImage out(labels.width(), labels.height(), kBackground);
  const SmoothWindow window{window_side(options) / 2, 1, kModeDepthGate_mm};
  parallel_ranges(labels.height(), kRowGrain, [&](int begin, int end) {
    const EvenWindows even(labels, window_side(options), begin, end);
    std::array<std::uint16_t, 256> count{};
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < labels.width(); ++u) {
        if (depth(u, v) == 0) continue;
        if (even(u, v)) {
          out(u, v) = labels(u, v);
          continue;
        }
        for_neighbours(depth, u, v, window, [&](int nu, int nv) { ++count[labels(nu, nv)]; });
        std::uint8_t best = labels(u, v);
        for_neighbours(depth, u, v, window, [&](int nu, int nv) {
          const std::uint8_t label = labels(nu, nv);
          const bool beats_tie = count[label] == count[best] && best != labels(u, v) && label < best;
          if (count[label] > count[best] || beats_tie) best = label;
        });
        out(u, v) = best;
        for_neighbours(depth, u, v, window, [&](int nu, int nv) { count[labels(nu, nv)] = 0; });
      }
    }
  });
  return out;
}

void mean_filter(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera,
                 const SmoothOptions& options, Posteriors& out) {
  out.resize_like(posteriors);
  const SmoothWindow window = smooth_window(options, camera);
  const int bits = excess_bits(posteriors.whole, window);
  if (bits > 0) {
    coarse_mean(posteriors, depth, window, bits, out);
    return;
  }
  parallel_ranges(posteriors.height, kRowGrain,
                  [&](int begin, int end) { mean_rows(posteriors, depth, window, begin, end, out); });
}

Posteriors mean_filter(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera,
                       const SmoothOptions& options) {
  Posteriors out;
  mean_filter(posteriors, depth, camera, options, out);
  return out;
}

}  // namespace vesalius
