#include "vesalius/cut_out_labeller.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/planes/find_planes.h"

namespace vesalius {
namespace {

Frame without_flat_surfaces(const Frame& frame) {
  const Mask flat = find_flat_surfaces(frame.depth, frame.camera, {}).pixels;
  Frame shown = depth_frame(frame.depth, frame.camera);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (flat[i] != 0) shown.depth[i] = 0;
  }
  return shown;
}

/// Returns the depth inside the box, with no reading outside the mask.
Frame keep_only(const Frame& frame, const Mask& mask, const Box& box) {
  Frame shown = depth_frame(crop(frame.depth, box), cropped(frame.camera, box));
  const Mask inside = crop(mask, box);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i] == 0) shown.depth[i] = 0;
  }
  return shown;
}

/// Writes posteriors with one more class, the background: what has a reading and was not shown.
void add_background(const Posteriors& of_parts, const DepthImage& shown, const DepthImage& depth, Posteriors& out) {
  Posteriors size = {.width = of_parts.width, .height = of_parts.height, .classes = of_parts.classes + 1, .sums = {}};
  size.whole = of_parts.whole;
  out.resize_like(size);
  out.headings = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    std::uint16_t* to = out.sums.data() + i * static_cast<std::size_t>(out.classes);
    std::copy_n(of_parts.sums.data() + i * static_cast<std::size_t>(of_parts.classes), of_parts.classes, to);
    to[of_parts.classes] = static_cast<std::uint16_t>(depth[i] != 0 && shown[i] == 0 ? out.whole : 0);
  }
}

/// Makes posteriors certain of the labels.
void make_certain(const LabelImage& labels, Posteriors& posteriors) {
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == kBackground) continue;
    std::uint16_t* sums = posteriors.sums.data() + i * static_cast<std::size_t>(posteriors.classes);
    std::fill_n(sums, posteriors.classes, std::uint16_t{0});
    sums[labels[i]] = static_cast<std::uint16_t>(posteriors.whole);
  }
}

}  // namespace

CutOutLabeller::CutOutLabeller(std::shared_ptr<const Labeller> of_parts, bool votes)
    : of_parts_(std::move(of_parts)), votes_(votes) {}

void CutOutLabeller::smooth(const Posteriors& of_parts, const Frame& shown, const SmoothOptions& options,
                            Posteriors& out) const {
  if (!votes_) {
    mean_filter(of_parts, shown.depth, shown.camera, options, out);
    return;
  }
  out = of_parts;
  make_certain(mode_filter(choose_labels(of_parts, shown.depth, {of_parts.classes}, {}), shown.depth, options), out);
}

void CutOutLabeller::label_into(const Frame& frame, float gate, Posteriors& out) const {
  const Frame shown = without_flat_surfaces(frame);
  Posteriors of_parts;
  of_parts_->label_into(shown, gate, of_parts);
  add_background(of_parts, shown.depth, frame.depth, out);
}

bool CutOutLabeller::label_and_smooth_into(const Frame& frame, float gate, const SmoothOptions& options,
                                           Posteriors& out, Posteriors& smooth) const {
  const Frame shown = without_flat_surfaces(frame);
  Posteriors of_parts, smoothed;
  of_parts_->label_into(shown, gate, of_parts);
  this->smooth(of_parts, shown, options, smoothed);
  add_background(of_parts, shown.depth, frame.depth, out);
  add_background(smoothed, shown.depth, frame.depth, smooth);
  return true;
}

bool CutOutLabeller::label_person_into(const Frame& frame, const Mask& person, const Box& box,
                                       const SmoothOptions& options, Posteriors& out) const {
  const Frame shown = keep_only(frame, person, box);
  const Posteriors of_parts = of_parts_->label(shown);
  Posteriors smoothed;
  smooth(of_parts, shown, options, smoothed);
  add_background(smoothed, shown.depth, shown.depth, out);
  return true;
}

}  // namespace vesalius
