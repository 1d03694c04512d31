#include "metrics/fit_samples.h"

#include <gmock/gmock.h>
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

/// Returns a candidate whose mask has the given columns of a picture of 10 x 1.
Trace trace_of(int from, int to) {
  Trace trace;
  Trace::Candidate candidate;
  candidate.grown = Mask(10, 1, 0);
  for (int u = from; u < to; ++u) candidate.grown(u, 0) = 1;
  candidate.refined.found = 7;
  trace.candidates.push_back(candidate);
  return trace;
}

TEST(JudgeSamples, AreJudgedByTheirOverlap) {
  const DepthImage depth(10, 1, 2000);
  FrameTruth truth;
  truth.people = 1;
  truth.person = Image<std::uint8_t>(10, 1, kBackground);
  for (int u = 0; u < 4; ++u) truth.person(u, 0) = 0;
  const auto kinds = [&](const FrameTruth& known, int from, int to) {
    std::vector<int> all;
    for (const BoostSample& s : judge_samples(trace_of(from, to), known, depth)) all.push_back(s.positive ? 1 : 0);
    return all;
  };
  EXPECT_THAT(kinds(truth, 0, 4), testing::ElementsAre(1));
  EXPECT_THAT(kinds(truth, 2, 4), testing::ElementsAre(1));  // IoU 0.5
  EXPECT_THAT(kinds(truth, 2, 6), testing::IsEmpty());       // IoU 1/3, which is undecided
  EXPECT_THAT(kinds(truth, 0, 1), testing::IsEmpty());       // a piece of a person
  EXPECT_THAT(kinds(truth, 5, 9), testing::ElementsAre(0));

  FrameTruth mask_only;
  mask_only.people = 1;
  mask_only.mask = Mask(10, 1, 0);
  for (int u = 0; u < 4; ++u) mask_only.mask(u, 0) = 255;
  EXPECT_THAT(kinds(mask_only, 2, 6), testing::ElementsAre(1));
  EXPECT_THAT(kinds(mask_only, 3, 6), testing::IsEmpty());
  EXPECT_THAT(kinds(mask_only, 2, 10), testing::ElementsAre(1));  // covers half of the mask
  EXPECT_THAT(kinds(mask_only, 4, 6), testing::ElementsAre(0));

  FrameTruth empty;
  empty.people = 0;
  EXPECT_THAT(kinds(empty, 0, 4), testing::ElementsAre(0));
  EXPECT_THAT(kinds({}, 0, 4), testing::IsEmpty());
}

}  // namespace

}  // namespace vesalius
