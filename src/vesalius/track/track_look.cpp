#include "vesalius/track/track_look.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vesalius/base/pixel_grid.h"

namespace vesalius {
namespace {

constexpr float kKept = 0.95F;  // share of what is known that stays as a frame is added: half of it in 14 frames
constexpr long kLeastSamples = 150;
constexpr int kMargin = 4;  // pixels of the grid, so that textures at the box's rim are seen as in the whole picture

/// Returns the box with a margin around, its corner on the grid, as far as the picture goes.
Box around(const Box& box, int step, const Mask& picture) {
  const int left = std::max(0, box.u - kMargin * step) / step * step;
  const int top = std::max(0, box.v - kMargin * step) / step * step;
  const int right = std::min(picture.width(), box.u + box.width + kMargin * step);
  const int bottom = std::min(picture.height(), box.v + box.height + kMargin * step);
  return {left, top, right - left, bottom - top};
}

}  // namespace

AppearanceHistogram look_of(const Frame& frame, const Mask& mask, const Box& box, const Appearance* appearance) {
  if (appearance == nullptr || box.width <= 0 || box.height <= 0) return {};
  const int step = grid_step(frame.camera, {});
  const Box part = around(box, step, mask);
  Frame cut;
  cut.camera = cropped(frame.camera, part);
  cut.depth = crop(frame.depth, part);
  if (!frame.colour.empty()) cut.colour = crop(frame.colour, part);
  const Mask inside = crop(mask, part);
  return step == 1 ? learn_appearance(cut, inside, *appearance)
                   : learn_appearance(every_nth(cut, step), every_nth(inside, step), *appearance);
}

void TrackLook::add_histogram(const AppearanceHistogram& frame) {
  if (frame.samples() == 0) return;
  histogram_.scale(kKept);
  histogram_.add(frame);
}

std::optional<float> look_distance(const AppearanceHistogram& a, const AppearanceHistogram& b,
                                   const Appearance* appearance) {
  if (appearance == nullptr || std::min(a.samples(), b.samples()) < kLeastSamples) return std::nullopt;
  const std::vector<float> p = a.probabilities(*appearance), q = b.probabilities(*appearance);
  double shared = 0.0;
  for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i) shared += std::sqrt(double(p[i] * q[i]));
  return float(-std::log(std::clamp(shared, 1e-6, 1.0)));
}

}  // namespace vesalius
