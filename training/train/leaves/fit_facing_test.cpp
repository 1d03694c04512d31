#include "train/leaves/fit_facing.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr int kParts = 3, kSides = 4;

/// Returns people whose features tell the heading through noise; heading 0 is `more` times as frequent.
std::vector<FacingSample> people(int count, int more, std::uint64_t seed) {
  Random random(seed, 0);
  std::vector<FacingSample> samples;
  for (int i = 0; i < count; ++i) {
    const auto drawn = static_cast<int>(random.below(static_cast<std::uint32_t>(kSides - 1 + more)));
    FacingSample sample{std::vector<float>(kParts * kSides + kParts + 1, 0.F), drawn < kSides ? drawn : 0};
    for (float& feature : sample.features) feature = static_cast<float>(random.uniform(-1.0, 1.0));
    sample.features[kSides + sample.heading] += 1.5F;
    sample.features.back() = 1.F;
    samples.push_back(sample);
  }
  return samples;
}

double share_right(const FacingModel& model, const std::vector<FacingSample>& samples) {
  double right = 0.0;
  for (const FacingSample& sample : samples) {
    const Eigen::Map<const Eigen::VectorXf> features(sample.features.data(),
                                                     static_cast<Eigen::Index>(sample.features.size()));
    Eigen::Index best = 0;
    facing(model, features).maxCoeff(&best);
    right += best == sample.heading ? 1.0 : 0.0;
  }
  return right / static_cast<double>(samples.size());
}

TEST(FitFacing, LearnsWhichFeaturesTellTheHeading) {
  const FacingModel model = fit_facing(people(800, 1, 1), kParts, kSides);
  EXPECT_GT(share_right(model, people(400, 1, 2)), 0.8);
}

TEST(FitFacing, ExpectsFrequentHeadingsHalfAsMuchMoreOften) {
  const FacingModel model = fit_facing(people(4000, 9, 3), kParts, kSides);
  Eigen::VectorXf nothing = Eigen::VectorXf::Zero(kParts * kSides + kParts + 1);
  nothing[nothing.size() - 1] = 1.F;
  const Eigen::VectorXf before = facing(model, nothing);
  EXPECT_GT(before[0], before[1]);
  EXPECT_LT(before[0], 9.F * before[1]);
}

TEST(FitFacing, GivesNoModelWithoutPeopleOfEveryHeading) {
  EXPECT_TRUE(fit_facing({}, kParts, kSides).empty());
  std::vector<FacingSample> some = people(100, 1, 4);
  std::erase_if(some, [](const FacingSample& sample) { return sample.heading == 2; });
  EXPECT_TRUE(fit_facing(some, kParts, kSides).empty());
  EXPECT_TRUE(fit_facing(people(10, 1, 5), kParts, 0).empty());
}

}  // namespace
}  // namespace vesalius
