#pragma once

#include "vesalius/body_model.h"
#include "vesalius/labeller.h"

namespace vesalius::test {

/// A labeller that calls every pixel background, so nobody is ever found.
class BlindLabeller : public Labeller {
 public:
  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    out = {depth.width(), depth.height(), paper_body().part_count() + 1, 255, {}};
    out.sums.assign(depth.size() * out.classes, 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) out.at(u, v)[out.classes - 1] = 255;
    }
  }
};

}  // namespace vesalius::test
