#include "train/sample_pixels.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "vesalius/capsule_person.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.F, 131.F, 79.5F, 59.5F};

std::vector<LabelledFrame> one_frame(bool person = true) {
  CapsuleScene scene;
  if (person) scene.people.emplace_back();
  return {render(scene, kCamera, paper_body())};
}

std::vector<TrainingPixel> sample(const std::vector<LabelledFrame>& frames, const SampleOptions& options,
                                  std::uint64_t seed = 1, std::uint64_t tree = 0) {
  return sample_pixels(frames, paper_body(), {}, options, seed, tree);
}

std::map<int, int> count_labels(const std::vector<TrainingPixel>& pixels) {
  std::map<int, int> counts;
  for (const TrainingPixel& pixel : pixels) ++counts[pixel.label];
  return counts;
}

TEST(SamplePixels, LabelsAndScalesAreThoseOfTheFrame) {
  const std::vector<LabelledFrame> frames = one_frame();
  const OffsetScaler scaler({}, kCamera);
  for (const TrainingPixel& pixel : sample(frames, {})) {
    const int truth = frames[0].labels(pixel.u, pixel.v);
    EXPECT_EQ(pixel.label, truth == kBackground ? 25 : truth);
    ASSERT_NE(frames[0].frame.depth(pixel.u, pixel.v), 0);
    EXPECT_EQ(pixel.scale.u, scaler.at(frames[0].frame.depth(pixel.u, pixel.v)).u);
  }
}

TEST(SamplePixels, BackgroundHasItsShare) {
  SampleOptions options;
  options.pixels_per_frame = 1000;
  options.background_share = 0.3F;
  EXPECT_EQ(count_labels(sample(one_frame(), options))[25], 300);
  EXPECT_EQ(sample(one_frame(false), options).size(), 300U) << "an empty room has no body pixels";
  options.background_share = 0.F;
  EXPECT_EQ(count_labels(sample(one_frame(), options)).count(25), 0U);
}

TEST(SamplePixels, BalancedPartsComeEquallyOften) {
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

TEST(SamplePixels, NearBackgroundLiesBesidePeople) {
  const std::vector<LabelledFrame> frames = one_frame();
  SampleOptions options;
  options.background_share = 1.F;
  options.near_share = 1.F;
  options.near_px = 5;
  const auto beside = [&](const TrainingPixel& pixel) {
    for (int dv = -5; dv <= 5; ++dv) {
      for (int du = -5; du <= 5; ++du) {
        const int u = pixel.u + du, v = pixel.v + dv;
        if (frames[0].labels.contains(u, v) && frames[0].labels(u, v) != kBackground) return true;
      }
    }
    return false;
  };
  const std::vector<TrainingPixel> pixels = sample(frames, options);
  EXPECT_GT(std::ranges::count_if(pixels, beside), 0.9 * static_cast<double>(pixels.size()));
}

TEST(SamplePixels, DependOnSeedAndTreeAlone) {
  const std::vector<LabelledFrame> frames = one_frame();
  const auto places = [&](std::uint64_t seed, std::uint64_t tree) {
    std::vector<int> result;
    for (const TrainingPixel& pixel : sample(frames, {}, seed, tree)) result.push_back(pixel.v * 160 + pixel.u);
    return result;
  };
  EXPECT_EQ(places(1, 0), places(1, 0));
  EXPECT_NE(places(1, 0), places(1, 1));
  EXPECT_NE(places(1, 0), places(2, 0));
}

TEST(SamplePixels, UnusableFramesAreErrors) {
  std::vector<LabelledFrame> frames = one_frame();
  frames[0].labels(3, 4) = 25;
  EXPECT_THROW(sample(frames, {}), Error);
  frames = one_frame();
  frames[0].labels = LabelImage(10, 10);
  EXPECT_THROW(sample(frames, {}), Error);
}

}  // namespace
}  // namespace vesalius
