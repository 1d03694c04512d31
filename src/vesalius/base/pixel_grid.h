#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"
#include "vesalius/base/parallel.h"

namespace vesalius {

/// How many of a picture's pixels the method looks at.
struct GridOptions {
  int step = 0;  ///< every so many pixels of every so many rows; 0: the least that leaves at most kMostPixels
};
void visit_options(const std::string& prefix, GridOptions& options, OptionVisitor& visitor);

/// 512x424 is looked at whole; 640x480 and 848x480 at every second pixel.
inline constexpr long kMostPixels = 250'000;

/// Step for pictures of this camera, at least 1.
int grid_step(const Camera& camera, const GridOptions& options);

/// Every `step`-th pixel of every `step`-th row, from the first on.
template <class T>
Image<T> every_nth(const Image<T>& image, int step) {
  Image<T> coarse((image.width() + step - 1) / step, (image.height() + step - 1) / step);
  for (int v = 0; v < coarse.height(); ++v) {
    const T* from = image.row(v * step);
    T* to = coarse.row(v);
    for (int u = 0; u < coarse.width(); ++u) to[u] = from[u * step];
  }
  return coarse;
}

/// The same of depth and colour, and the camera of these pixels: each keeps its point.
Frame every_nth(const Frame& frame, int step);

/// A pixel of a grid, in the whole picture's coordinates.
struct GridPixel {
  bool found = false;
  int u = 0, v = 0;
};

/// Of the grid's pixels around (u, v), itself if it is one, that whose depth is nearest to its own, if it is within so
/// many millimetres; of several the first row by row.
inline GridPixel nearest_on_grid(const DepthImage& depth, int step, int u, int v, int within_mm) {
  GridPixel nearest;
  int least = within_mm + 1;
  for (int nv = v - v % step; nv < v + step; nv += step) {
    for (int nu = u - u % step; nu < u + step; nu += step) {
      if (!depth.contains(nu, nv) || depth(nu, nv) == 0) continue;
      const int apart = std::abs(depth(nu, nv) - depth(u, v));
      if (apart >= least) continue;
      least = apart;
      nearest = {true, nu, nv};
    }
  }
  return nearest;
}

/// Brings what was found on a grid back to all pixels: each takes after that one of the grid's pixels around it whose
/// depth is nearest, if it is within 5 cm and 3 mm more for every square metre of its own depth.
class GridGuide {
 public:
  /// `depth` is the whole picture; it must outlive the guide. Throws Error for a step below 1.
  GridGuide(const DepthImage& depth, int step);

  /// `outside` where depth has no reading or no pixel around is near enough.
  template <class T>
  Image<T> enlarge(const Image<T>& coarse, T outside) const {
    return enlarge(coarse, outside, {0, 0, coarse.width(), coarse.height()});
  }

  /// Outside `box`, of the coarse picture, that one holds nothing but `outside`.
  template <class T>
  Image<T> enlarge(const Image<T>& coarse, T outside, const Box& box) const {
    Image<T> out(depth_.width(), depth_.height(), outside);
    const int left = std::max(0, (box.u - 1) * step_ + 1), right = std::min(out.width(), (box.u + box.width) * step_);
    const int top = std::max(0, (box.v - 1) * step_ + 1), bottom = std::min(out.height(), (box.v + box.height) * step_);
    parallel_ranges(std::max(0, bottom - top), kRows, [&](int begin, int end) {
      for (int v = top + begin; v < top + end; ++v) {
        for (int u = left; u < right; ++u) {
          if (depth_(u, v) == 0) continue;
          const GridPixel source = nearest_on_grid(depth_, step_, u, v, within(depth_(u, v)));
          if (source.found) out(u, v) = coarse(source.u / step_, source.v / step_);
        }
      }
    });
    return out;
  }

 private:
  static constexpr int kRows = 16;

  /// Millimetres of depth that a pixel may lie from the one it takes after.
  static int within(int z_mm) { return 50 + static_cast<int>(static_cast<std::int64_t>(z_mm) * z_mm * 3 / 1'000'000); }

  const DepthImage& depth_;
  int step_;
};

}  // namespace vesalius
