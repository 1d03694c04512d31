#include "train/samples/sample_pixels.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "capsule/capsule_person.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.F, 131.F, 79.5F, 59.5F};

LabelledFrame one_frame(bool person = true) {
  CapsuleScene scene;
  if (person) scene.people.emplace_back();
  return render(scene, kCamera, paper_body());
}

std::vector<TrainingSample> sample(const LabelledFrame& frame, const SampleOptions& options, std::uint64_t seed = 1) {
  Random random(seed);
  return draw_samples(frame, paper_body(), options, random, "frame").samples;
}

std::map<int, int> count_labels(const std::vector<TrainingSample>& samples) {
  std::map<int, int> counts;
  for (const TrainingSample& each : samples) ++counts[each.label];
  return counts;
}

TEST(SamplePixels, TakesLabelsAndDepthFromTheFrame) {
  const LabelledFrame frame = one_frame();
  for (const TrainingSample& each : sample(frame, {})) {
    const int truth = frame.labels(each.u, each.v);
    EXPECT_EQ(each.label, truth == kBackground ? 25 : truth);
    ASSERT_NE(each.depth_mm, 0);
    EXPECT_EQ(each.depth_mm, frame.frame.depth(each.u, each.v));
  }
}

TEST(SamplePixels, GivesTheBackgroundItsShare) {
  SampleOptions options;
  options.pixels_per_frame = 1000;
  options.background_share = 0.3F;
  EXPECT_EQ(count_labels(sample(one_frame(), options))[25], 300);
  EXPECT_EQ(sample(one_frame(false), options).size(), 300U) << "an empty room has no body pixels";
  options.background_share = 0.F;
  EXPECT_EQ(count_labels(sample(one_frame(), options)).count(25), 0U);
}

TEST(SamplePixels, DrawsBalancedPartsEquallyOften) {
  SampleOptions options;
  options.pixels_per_frame = 25000;
  options.background_share = 0.F;
  options.balanced_share = 1.F;
  for (const auto& [label, count] : count_labels(sample(one_frame(), options))) {
    EXPECT_NEAR(count, 1000, 150) << label;  // 5 sigma
  }
  options.balanced_share = 0.F;
  std::map<int, int> counts = count_labels(sample(one_frame(), options));
  EXPECT_GT(counts[paper_body().find_part("l_chest")], 5 * counts[paper_body().find_part("l_elbow")]);
}

TEST(SamplePixels, DrawsNearBackgroundBesidePeople) {
  const LabelledFrame frame = one_frame();
  SampleOptions options;
  options.background_share = 1.F;
  options.near_share = 1.F;
  options.near_px = 5;
  const auto beside = [&](const TrainingSample& each) {
    for (int dv = -5; dv <= 5; ++dv) {
      for (int du = -5; du <= 5; ++du) {
        const int u = each.u + du, v = each.v + dv;
        if (frame.labels.contains(u, v) && frame.labels(u, v) != kBackground) return true;
      }
    }
    return false;
  };
  const std::vector<TrainingSample> samples = sample(frame, options);
  EXPECT_GT(std::ranges::count_if(samples, beside), 0.9 * static_cast<double>(samples.size()));
}

TEST(SamplePixels, DrawsAPoolOfBackgroundThatIsLargerInEmptyRooms) {
  SampleOptions options;
  options.hard_pool = 50;
  Random random(1);
  const DrawnSamples with = draw_samples(one_frame(), paper_body(), options, random, "frame");
  EXPECT_EQ(with.pool.size(), 50U);
  EXPECT_EQ(count_labels(with.pool)[25], 50);
  EXPECT_EQ(draw_samples(one_frame(false), paper_body(), options, random, "frame").pool.size(), 200U);
}

TEST(SamplePixels, CountsReadingsOfEveryClass) {
  LabelledFrame frame = one_frame();
  frame.frame.depth(0, 0) = 0;
  frame.frame.depth(1, 0) = 1000;
  frame.labels(1, 0) = 3;
  std::vector<std::uint64_t> truth(26, 0);
  for (std::size_t i = 0; i < frame.labels.size(); ++i) {
    if (frame.frame.depth[i] != 0) ++truth[frame.labels[i] == kBackground ? 25 : frame.labels[i]];
  }
  Random random(1);
  EXPECT_EQ(draw_samples(frame, paper_body(), {}, random, "frame").class_pixels, truth);
}

TEST(SamplePixels, NamesUnusableFrames) {
  Random random(1);
  LabelledFrame frame = one_frame();
  frame.labels(3, 4) = 25;
  frame.frame.depth(3, 4) = 1000;
  try {
    draw_samples(frame, paper_body(), {}, random, "training frame 7");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("training frame 7: label 25 at pixel (3, 4)"));
  }
  frame = one_frame();
  frame.labels = LabelImage(10, 10);
  EXPECT_THROW(draw_samples(frame, paper_body(), {}, random, "frame"), Error);
}

}  // namespace
}  // namespace vesalius
