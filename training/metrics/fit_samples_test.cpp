#include "metrics/fit_samples.h"

#include <gtest/gtest.h>

#include "metrics/test_frames.h"
#include "vesalius/forest/body_context.h"

namespace vesalius {
namespace {

/// A labeller that finds half a neck everywhere.
class Unsure : public Labeller {
 public:
  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    const int classes = paper_body().part_count() + 1;
    out = {depth.width(), depth.height(), classes, 255, {}};
    out.sums.assign(depth.size() * static_cast<std::size_t>(classes), 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0) continue;
        out.at(u, v)[paper_body().find_part("neck")] = 128;
        out.at(u, v)[classes - 1] = 127;
      }
    }
  }
};

TEST(ContextSamples, AreCellsWithTheirTruth) {
  const auto labeller = std::make_shared<Unsure>();
  long bodies = 0, others = 0;
  for (int i = 0; i < 20; ++i) {
    TrueFrame frame = test::capsule_frame(1.8F, 0.F);
    frame.frame.name = std::to_string(i);
    const std::vector<BoostSample> samples = context_samples(frame, labeller, {});
    for (const BoostSample& sample : samples) {
      ASSERT_EQ(sample.features.size(), static_cast<std::size_t>(BodySurroundings::feature_count(paper_body())));
      ++(sample.positive ? bodies : others);
    }
  }
  const TrueFrame frame = test::capsule_frame(1.8F, 0.F);
  long true_bodies = 0, readings = 0;
  for (std::size_t i = 0; i < frame.frame.depth.size(); ++i) {
    if (frame.frame.depth[i] == 0) continue;
    ++readings;
    true_bodies += frame.truth.labels[i] != kBackground ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(bodies + others), 20.0 * static_cast<double>(readings) / kContextEvery,
              0.1 * 20.0 * static_cast<double>(readings) / kContextEvery);
  EXPECT_NEAR(static_cast<double>(bodies) / static_cast<double>(bodies + others),
              static_cast<double>(true_bodies) / static_cast<double>(readings), 0.03);
}

TEST(ContextSamples, AreTheSameForTheSameFrame) {
  const auto labeller = std::make_shared<Unsure>();
  const auto of = [&](const std::string& name) {
    TrueFrame frame = test::capsule_frame(1.8F, 0.F);
    frame.frame.name = name;
    std::vector<std::vector<float>> all;
    for (const BoostSample& sample : context_samples(frame, labeller, {})) all.push_back(sample.features);
    return all;
  };
  EXPECT_EQ(of("a"), of("a"));
  EXPECT_NE(of("a"), of("b")) << "other cells of other frames";
}

TEST(ContextSamples, NeedLabels) {
  TrueFrame frame = test::capsule_frame(1.8F, 0.F);
  frame.truth.labels = {};
  EXPECT_TRUE(context_samples(frame, std::make_shared<Unsure>(), {}).empty());
}

}  // namespace
}  // namespace vesalius
