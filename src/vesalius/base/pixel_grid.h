#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>

#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/parallel.h"
#include "vesalius/people_options.h"
#include "vesalius/stage_times.h"

namespace vesalius {

/// The method looks at every pixel of pictures of up to this size, e.g. 512x424, and at every second pixel of 640x480
/// and 848x480.
inline constexpr long kMostPixels = 250'000;

/// Of pictures that have more than so many, as few are looked at as leave so many pixels to a radian: at 3 m one of
/// them is 1 cm wide. Decision 60 has what more and fewer bring.
inline constexpr long kEnoughPixels = 100'000;
inline constexpr float kEnoughFocalPx = 300.F;

/// Columns and rows of the grid that labellers take at once: a network halves its picture five times.
inline constexpr int kGridBlock = 32;

/// Rows of a picture that a thread takes at once (parallel_ranges).
inline constexpr int kRowGrain = 8;

/// Returns the step for pictures of this camera, at least 1: the option's, or else the least that leaves at most
/// kMostPixels, or a larger one that leaves at least a focal length of kEnoughFocalPx.
int grid_step(const Camera& camera, const GridOptions& options);

/// Returns every `step`-th pixel of every `step`-th row, beginning with the first.
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

/// Returns these pixels of depth and colour, with the camera that gives each of them the same point as before. `depth`
/// is the frame's, or that in its place.
Frame every_nth(const Frame& frame, const DepthImage& depth, int step);
inline Frame every_nth(const Frame& frame, int step) { return every_nth(frame, frame.depth, step); }

/// Returns the camera of the picture inside a box, which gives each pixel the same point as before.
Camera cropped(Camera camera, const Box& box);
/// Returns the frame of the picture inside a box.
Frame cropped(const Frame& frame, const Box& box);

/// Returns a picture of the camera's size with `part` in the box and `outside` around it.
template <class T>
Image<T> uncropped(const Image<T>& part, const Box& box, const Camera& camera, T outside) {
  Image<T> out(camera.width, camera.height, outside);
  for (int v = 0; v < box.height; ++v) std::copy_n(part.row(v), box.width, out.row(box.v + v) + box.u);
  return out;
}

/// Returns the box in whole blocks of the grid, as far as the picture goes. It begins at a pixel of the grid.
Box in_blocks(const Box& box, const Camera& camera, int step);

/// A pixel of a grid, in the whole picture's coordinates.
struct GridPixel {
  bool found = false;
  int u = 0, v = 0;
};

/// Returns that one of the up to four grid pixels around (u, v) whose depth is nearest to that of (u, v), or none if
/// all differ by more than `within_mm`. A pixel of the grid has only itself around it. If several are equally near, the
/// first in row order is returned.
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

/// Returns by how much a pixel's depth may differ from that of the grid pixel which speaks for it: 5 cm and 3 mm more
/// for every square metre of the pixel's own depth, in millimetres.
inline int grid_within_mm(int z_mm) { return 50 + int(static_cast<std::int64_t>(z_mm) * z_mm * 3 / 1'000'000); }

/// Transfers results on a grid to all pixels. Each pixel takes the value of the surrounding grid pixel that is nearest
/// in depth, if that is near enough (grid_within_mm).
class GridGuide {
 public:
  /// `depth` is the whole picture and must outlive the guide. Throws Error for a step below 1.
  GridGuide(const DepthImage& depth, int step);

  /// Returns a picture of full size. Pixels without a reading, or without a grid pixel near enough, become `outside`;
  /// all do where `coarse` is empty.
  template <class T>
  Image<T> enlarge(const Image<T>& coarse, T outside) const {
    Image<T> out(depth_.width(), depth_.height(), outside);
    each(
        whole_box({0, 0, coarse.width(), coarse.height()}),
        [&](int column, int row) { return coarse(column, row) != outside; },
        [&](int u, int v, int column, int row) { out(u, v) = coarse(column, row); });
    return out;
  }

  /// Returns the box around the pixels that may take the value of one in a box of the coarse picture.
  Box whole_box(const Box& coarse) const {
    const int left = std::max(0, (coarse.u - 1) * step_ + 1), top = std::max(0, (coarse.v - 1) * step_ + 1);
    const int right = std::min(depth_.width(), (coarse.u + coarse.width) * step_);
    const int bottom = std::min(depth_.height(), (coarse.v + coarse.height) * step_);
    return {left, top, std::max(0, right - left), std::max(0, bottom - top)};
  }

  /// Calls `use(u, v, column, row)` for the pixels in a box that take the value of one of the coarse picture, on all
  /// threads. Those may be left out around which `matters(column, row)` is true of none.
  template <class Matters, class Use>
  void each(const Box& box, const Matters& matters, const Use& use) const {
    parallel_ranges(box.height, kRows, [&](int begin, int end) {
      for (int v = box.v + begin; v < box.v + end; ++v) each_in_row(v, box.u, box.u + box.width, matters, use);
    });
  }

  int width() const { return depth_.width(); }
  int height() const { return depth_.height(); }
  /// Returns the row-major index that a pixel of the coarse picture has in the whole one.
  int whole_index(int coarse_index) const {
    const int coarse_width = (depth_.width() + step_ - 1) / step_;
    return coarse_index / coarse_width * step_ * depth_.width() + coarse_index % coarse_width * step_;
  }

 private:
  static constexpr int kRows = 16;

  /// As nearest_on_grid finds them, without a division for each.
  template <class Matters, class Use>
  void each_in_row(int v, int left, int right, const Matters& matters, const Use& use) const {
    const int row = v / step_, above = row * step_, below = above + step_;
    const bool between = above != v && below < depth_.height();
    const std::uint16_t *here = depth_.row(v), *upper = depth_.row(above), *lower = depth_.row(between ? below : above);
    const auto some = [&](int column) {
      return column * step_ < depth_.width() && (matters(column, row) || (between && matters(column, row + 1)));
    };
    bool these = false, those = some(left / step_);
    for (int column = left / step_, at = column * step_; at < right; ++column, at += step_) {
      const int next = at + step_;
      these = std::exchange(those, some(column + 1));
      if (!these && !those) continue;
      for (int u = std::max(left, at); u < std::min(right, next); ++u) {
        if (here[u] == 0) continue;
        int least = grid_within_mm(here[u]) + 1, nearest = -1;
        const auto ask = [&](int reading, int which) {
          const int apart = std::abs(reading - here[u]);
          if (reading == 0 || apart >= least) return;
          least = apart;
          nearest = which;
        };
        const bool beside = u != at && next < depth_.width();
        ask(upper[at], 0);
        if (beside) ask(upper[next], 1);
        if (between) ask(lower[at], 2);
        if (beside && between) ask(lower[next], 3);
        if (nearest >= 0) use(u, v, column + nearest % 2, row + nearest / 2);
      }
    }
  }

  const DepthImage& depth_;
  int step_;
};

/// Runs `work(grid, step)` on the grid's pixels of a frame and transfers its result to all pixels by `enlarge(guide,
/// result)`. If the grid is the whole picture, nothing is enlarged. `depth` is the frame's, or that in its place. Adds
/// the time of selecting and enlarging to Stage::grid.
template <class Work, class Enlarge>
auto on_grid(const Frame& frame, const DepthImage& depth, const GridOptions& options, StageTimes* times,
             const Work& work, const Enlarge& enlarge) {
  const int step = grid_step(frame.camera, options);
  if (step == 1 && &depth == &frame.depth) return work(frame, 1);
  StageClock before(times);
  const Frame grid = every_nth(frame, depth, step);
  before.lap(Stage::grid);
  auto result = work(grid, step);
  if (step == 1) return result;
  StageClock after(times);
  enlarge(GridGuide(depth, step), result);
  after.lap(Stage::grid);
  return result;
}

}  // namespace vesalius
