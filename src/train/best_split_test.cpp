#include "train/best_split.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "train/grow_forest.h"
#include "vesalius/capsule_person.h"

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.F, 131.F, 79.5F, 59.5F};
constexpr int kClasses = 26;

struct Data {
  std::vector<LabelledFrame> frames;
  std::vector<TrainingPixel> pixels;
};

Data make_data(int pixels) {
  CapsuleScene scene;
  scene.people.emplace_back();
  Data data{{render(scene, kCamera, paper_body())}, {}};
  SampleOptions options;
  options.pixels_per_frame = pixels;
  data.pixels = sample_pixels(data.frames, paper_body(), training_convention(), options, 3, 0);
  return data;
}

double entropy_bits(const std::map<int, int>& counts) {
  double total = 0.0, bits = 0.0;
  for (const auto& [label, count] : counts) total += count;
  for (const auto& [label, count] : counts) bits -= count / total * std::log2(count / total);
  return bits;
}

/// Information gain straight from its definition.
double gain_of(const Data& data, const TreeNode& node, int threshold, std::size_t min_leaf) {
  std::map<int, int> all, left, right;
  double left_total = 0.0;
  for (const TrainingPixel& pixel : data.pixels) {
    const bool goes_left = feature_of(pixel, data.frames, training_convention(), node) <= threshold;
    ++all[pixel.label];
    ++(goes_left ? left : right)[pixel.label];
    left_total += goes_left;
  }
  const double total = static_cast<double>(data.pixels.size());
  const auto least = static_cast<double>(min_leaf);
  if (left_total < least || total - left_total < least) return 0.0;
  return entropy_bits(all) - left_total / total * entropy_bits(left) -
         (total - left_total) / total * entropy_bits(right);
}

TEST(BestSplit, BestThresholdIsTheOneThatBruteForceFinds) {
  const Data data = make_data(200);
  const EntropyTable entropy(data.pixels.size());
  Random random(5);
  for (int trial = 0; trial < 30; ++trial) {
    TreeNode node;
    node.du1 = static_cast<std::int16_t>(random.below(100)) - 50;
    node.dv1 = static_cast<std::int16_t>(random.below(100)) - 50;
    node.du2 = static_cast<std::int16_t>(random.below(100)) - 50;
    const std::vector<int> thresholds = {-900, -300, -40, -3, 0, 7, 60, 400, 1000};
    double best_gain = 0.0;
    int expected_mm = 0;
    for (const int threshold : thresholds) {
      const double gain = gain_of(data, node, threshold, 10);
      if (gain > best_gain + 1e-9) {
        best_gain = gain;
        expected_mm = threshold;
      }
    }
    const Candidate candidate{node, thresholds};
    const std::vector<IntervalCounts> intervals =
        count_intervals({&candidate, 1}, data.pixels, data.frames, training_convention(), kClasses);
    const Split split = best_threshold(candidate, intervals[0], 10, entropy);
    EXPECT_NEAR(split.gain, best_gain, 1e-9);
    if (best_gain > 0.0) {
      EXPECT_EQ(split.node.threshold_mm, expected_mm);
    }
  }
}

TEST(BestSplit, ChosenSplitIsWorthWhatItSays) {
  const Data data = make_data(300);
  const EntropyTable entropy(data.pixels.size());
  SplitOptions options;
  Random random(9);
  const Split split = best_split(data.pixels, data.frames, training_convention(), kClasses, options, entropy, random);
  EXPECT_GT(split.gain, 0.1);
  EXPECT_NEAR(split.gain, gain_of(data, split.node, split.node.threshold_mm, 20), 1e-9);
}

TEST(BestSplit, MoreCandidatesNeverGainLess) {
  const Data data = make_data(300);
  const EntropyTable entropy(data.pixels.size());
  double last = 0.0;
  for (const int candidates : {1, 5, 50}) {
    SplitOptions options;
    options.candidates = candidates;
    Random random(9);
    const Split split = best_split(data.pixels, data.frames, training_convention(), kClasses, options, entropy, random);
    EXPECT_GE(split.gain, last);
    last = split.gain;
  }
}

TEST(BestSplit, OffsetsStayWithinReach) {
  const Data data = make_data(100);
  const EntropyTable entropy(data.pixels.size());
  SplitOptions options;
  options.max_offset_m = 0.1F;  // 20 units
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const TreeNode node =
        best_split(data.pixels, data.frames, training_convention(), kClasses, options, entropy, random).node;
    EXPECT_LE(std::hypot(node.du1, node.dv1), 20.8);
    EXPECT_LE(std::hypot(node.du2, node.dv2), 20.8);
  }
}

TEST(BestSplit, PixelsOfOneClassAreNotWorthSplitting) {
  Data data = make_data(200);
  for (TrainingPixel& pixel : data.pixels) pixel.label = 3;
  const EntropyTable entropy(data.pixels.size());
  Random random(1);
  EXPECT_EQ(best_split(data.pixels, data.frames, training_convention(), kClasses, {}, entropy, random).gain, 0.0);
}

}  // namespace
}  // namespace vesalius
