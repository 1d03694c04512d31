#include "vesalius/base/pixel_grid.h"

#include <algorithm>
#include <utility>

#include "vesalius/error.h"

namespace vesalius {

int grid_step(const Camera& camera, const GridOptions& options) {
  if (options.step > 0) return options.step;
  const auto left = [&](long step) { return ((camera.width + step - 1) / step) * ((camera.height + step - 1) / step); };
  int step = 1;
  while (left(step) > kMostPixels) ++step;
  const float focal = std::min(camera.fx, camera.fy);
  while (left(step) > kEnoughPixels && focal >= kEnoughFocalPx * float(step + 1)) ++step;
  return step;
}

Frame every_nth(const Frame& frame, const DepthImage& depth, int step) {
  const Camera& c = frame.camera;
  const auto by = float(step);
  Frame coarse;
  coarse.name = frame.name;
  coarse.time_s = frame.time_s;
  coarse.depth = every_nth(depth, step);
  if (!frame.colour.empty()) coarse.colour = every_nth(frame.colour, step);
  // Pixel u of the grid is pixel step * u of the picture.
  coarse.camera = {coarse.depth.width(), coarse.depth.height(), c.fx / by, c.fy / by, c.cx / by, c.cy / by};
  return coarse;
}

Camera cropped(Camera camera, const Box& box) {
  camera.width = box.width;
  camera.height = box.height;
  camera.cx -= float(box.u);
  camera.cy -= float(box.v);
  return camera;
}

Frame cropped(const Frame& frame, const Box& box) {
  Frame part;
  part.name = frame.name;
  part.time_s = frame.time_s;
  part.up = frame.up;
  part.quarter_turns = frame.quarter_turns;
  part.depth = crop(frame.depth, box);
  if (!frame.colour.empty()) part.colour = crop(frame.colour, box);
  part.camera = cropped(frame.camera, box);
  return part;
}

Box in_blocks(const Box& box, const Camera& camera, int step) {
  constexpr int kAligned = 4;  // columns and rows of the grid that are looked at together (BackgroundGate)
  const int block = kGridBlock * step, aligned = kAligned * step;
  const auto side = [&](int from, int length, int whole) {
    const int wide = std::min(whole, (length + 2 * aligned + block - 1) / block * block);
    int begin = std::clamp(from - (wide - length) / 2, 0, whole - wide);
    begin -= begin % aligned;
    return std::pair{begin, std::max(wide, from + length - begin)};
  };
  const auto [u, width] = side(box.u, box.width, camera.width);
  const auto [v, height] = side(box.v, box.height, camera.height);
  return {u, v, width, height};
}

GridGuide::GridGuide(const DepthImage& depth, int step) : depth_(depth), step_(step) {
  if (step < 1) throw Error("a grid's step must be at least 1");
}

}  // namespace vesalius
