#pragma once

#include "vesalius/forest/label_pixels.h"

namespace vesalius::test {

/// A labeller that calls every pixel background, so nobody is ever found.
class BlindLabeller : public PixelLabeller {
 public:
  void label_into(const DepthImage& depth, const Camera& /*camera*/, float /*gate*/, Posteriors& out) const override {
    out = {depth.width(), depth.height(), paper_body().part_count() + 1, 1, {}};
    out.sums.assign(depth.size() * out.classes, 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) out.at(u, v)[out.classes - 1] = 255;
    }
  }
  const BodyModel& body() const override { return paper_body(); }
  bool has_background() const override { return true; }
  bool has_distributions() const override { return true; }
};

}  // namespace vesalius::test
