#pragma once

// What labellers of tests whose pixels have headings share.

#include "vesalius/body_model.h"
#include "vesalius/forest/facing.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius::test {

inline constexpr int kTestHeadings = 8;

/// Returns posteriors of a picture of this size for the paper's parts and a background, with headings, all zero.
inline Posteriors headed_posteriors(const DepthImage& depth) {
  const int classes = paper_body().part_count() + 1;
  Posteriors out{.width = depth.width(), .height = depth.height(), .classes = classes, .whole = 255, .sums = {}};
  out.headings = kTestHeadings;
  out.sums.assign(depth.size() * static_cast<std::size_t>(classes), 0);
  out.turns.assign(depth.size() * out.turn_count(), 0);
  return out;
}

/// Returns a regression of headings that takes everybody for seen from behind.
inline FacingModel seen_from_behind() {
  FacingModel model{kTestHeadings, paper_body().part_count(), {}};
  model.weights.resize(kTestHeadings * model.features(), 0.F);
  model.weights[kTestHeadings / 2 * model.features() + model.features() - 1] = 50.F;
  return model;
}

}  // namespace vesalius::test
