#include "train/feature_rows.h"

#include <gmock/gmock.h>

#include <limits>

#include "train/samples/walk_samples.h"
#include "train/split_candidates.h"
#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"
#include "vesalius/error.h"
#include "vesalius/forest/tree_walk.h"

namespace vesalius {
namespace {

/// Returns noise with holes, so that every probe reads a different value.
DepthImage random_depth(int width, int height, Random& random) {
  DepthImage depth(width, height, 0);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = random.below(5) == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(400 + random.below(65000));
  }
  return depth;
}

TrainingSample random_sample(const DepthImage& depth, Random& random) {
  TrainingSample sample;
  do {
    sample.u = static_cast<std::int16_t>(random.below(static_cast<std::uint32_t>(depth.width())));
    sample.v = static_cast<std::int16_t>(random.below(static_cast<std::uint32_t>(depth.height())));
    sample.depth_mm = depth(sample.u, sample.v);
  } while (sample.depth_mm == 0);
  return sample;
}

/// Returns the value that detection computes, clamped to the range of a row.
std::int16_t truth(const DepthImage& depth, const Camera& camera, const FeatureConvention& convention,
                   const TrainingSample& sample, const TreeNode& node) {
  const OffsetScale scale = OffsetScaler(convention, camera).at(sample.depth_mm);
  const int value = feature_mm(depth, convention, scale, sample.u, sample.v, node);
  using Limits = std::numeric_limits<std::int16_t>;
  return static_cast<std::int16_t>(std::clamp<int>(value, Limits::min(), Limits::max()));
}

TEST(FeatureRows, AgreeWithDetectionOnEveryInstructionSet) {
  FeatureConvention clipped;
  clipped.clip_mm = 1000;
  FeatureConvention odd;
  odd.hole_mm = 9000;
  odd.outside_mm = 60000;
  Random random(11);
  for (const FeatureConvention& convention : {FeatureConvention{}, clipped, odd}) {
    for (const auto& [width, height] : {std::pair{64, 48}, std::pair{37, 21}, std::pair{1, 1}}) {
      const Camera camera{
          width, height, 60.F, 55.F, 0.5F * static_cast<float>(width), 0.5F * static_cast<float>(height)};
      DepthImage depth = random_depth(width, height, random);
      depth[0] = 700;
      FrameStore store(convention);
      store.add(camera, depth);
      FrameUnpacker unpack(store);
      SplitOptions options;
      options.max_offset_m = 20.F;
      const CandidateTable table = draw_candidates(convention, options, 37, random);
      std::vector<std::int16_t> values(table.padded), packed = values;
      for_each_target([&](const char* target) {
        for (int s = 0; s < 20; ++s) {
          const TrainingSample sample = random_sample(depth, random);
          evaluate_candidates(unpack(0), convention, sample, table.offsets.data(), table.padded, values.data());
          for (int c = 0; c < table.count; ++c) {
            ASSERT_EQ(values[c], truth(depth, camera, convention, sample, table.node(c)))
                << target << " candidate " << c;
          }
          evaluate_candidates(store[0], convention, sample, table.offsets.data(), table.padded, packed.data());
          ASSERT_EQ(packed, values);
        }
      });
    }
  }
}

TEST(WalkSamples, ComputesTheFeatureOfDetection) {
  Random random(12);
  FeatureConvention convention;
  convention.clip_mm = 800;
  const Camera camera{50, 40, 50.F, 50.F, 25.F, 20.F};
  const DepthImage depth = random_depth(50, 40, random);
  FrameStore store(convention);
  store.add(camera, depth);
  const CandidateTable table = draw_candidates(convention, {}, 50, random);
  for (int c = 0; c < table.count; ++c) {
    const TrainingSample sample = random_sample(depth, random);
    EXPECT_EQ(feature_of(store[0], convention, sample, table.node(c)),
              feature_mm(depth, convention, OffsetScaler(convention, camera).at(sample.depth_mm), sample.u, sample.v,
                         table.node(c)));
  }
}

}  // namespace
}  // namespace vesalius
