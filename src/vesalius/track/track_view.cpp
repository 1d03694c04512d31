#include "vesalius/track/track_view.h"

#include <cstdlib>
#include <utility>

#include "vesalius/base/pixel_grid.h"

namespace vesalius {
namespace {

constexpr int kApart = 16;              // pixels from one that is compared to the next
constexpr float kMostChanged = 0.015F;  // share of the compared ones: somebody who comes in at four metres is larger

bool is_inside(const Box& box, int u, int v) {
  return u >= box.u && v >= box.v && u < box.u + box.width && v < box.v + box.height;
}

}  // namespace

void TrackView::take_frame(const Frame& frame, double time_s, std::vector<Plane> planes, const Box& people) {
  width_ = frame.depth.width();
  height_ = frame.depth.height();
  depth_ = every_nth(frame.depth, kApart);
  people_ = people;
  planes_ = std::move(planes);
  time_s_ = time_s;
}

bool TrackView::unchanged(const Frame& frame, const Box& people) const {
  if (depth_.empty() || frame.depth.width() != width_ || frame.depth.height() != height_) return false;
  int compared = 0, changed = 0;
  for (int v = 0; v < depth_.height(); ++v) {
    const std::uint16_t* now = frame.depth.row(v * kApart);
    for (int u = 0; u < depth_.width(); ++u) {
      const int z = now[u * kApart], before = depth_(u, v);
      if (z == 0 || before == 0) continue;  // what flickers
      if (is_inside(people, u * kApart, v * kApart) || is_inside(people_, u * kApart, v * kApart)) continue;
      ++compared;
      changed += std::abs(z - before) > 2 * grid_within_mm(z) ? 1 : 0;
    }
  }
  return float(changed) <= kMostChanged * float(compared);
}

}  // namespace vesalius
