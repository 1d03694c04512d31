#include "train/estimate_training.h"

#include <gtest/gtest.h>

#include "capsule/capsule_person.h"
#include "vesalius/base/error.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr Camera kCamera{80, 60, 66.F, 66.F, 39.5F, 29.5F};

/// Returns noisy frames of people in different poses, so that leaves are not pure by accident.
std::vector<LabelledFrame> people(int count) {
  std::vector<LabelledFrame> frames;
  for (int i = 0; i < count; ++i) {
    Random random(7, static_cast<std::uint64_t>(i));
    CapsulePerson person;
    person.pose.yaw = static_cast<float>(random.uniform(-0.7, 0.7));
    person.pose.l_arm.raise = static_cast<float>(random.uniform(0.2, 2.5));
    person.pose.r_arm.raise = static_cast<float>(random.uniform(0.2, 2.5));
    person.feet.x() = static_cast<float>(random.uniform(-0.5, 0.5));
    CapsuleScene scene;
    scene.people = {person};
    frames.push_back(render(scene, kCamera, paper_body()));
    add_sensor_noise(frames.back().frame, static_cast<std::uint64_t>(i));
  }
  return frames;
}

TEST(EstimateGrowth, CountsEvaluationsWithinThirtyPercent) {
  const std::vector<LabelledFrame> frames = people(200);
  TrainOptions options;
  options.trees = 1;
  options.hard_trees = 0;
  options.sample.held_out_share = 0.F;
  options.grow.split.split_pixels = 5000;
  TrainingSet set(paper_body(), training_convention(options), options.sample, 1);
  for (const LabelledFrame& frame : frames) set.add(frame);
  GrowProgress progress;
  grow_tree(set, options.grow, 0, &progress);
  const std::vector<LabelledFrame> some(frames.begin(), frames.begin() + 50);
  const GrowthEstimate estimate = estimate_growth(some, paper_body(), set.samples().size(), options, 1);
  const auto done = static_cast<double>(progress.evaluations);
  EXPECT_NEAR(estimate.evaluations, done, 0.3 * done);
  EXPECT_GT(estimate.evaluations_per_s, 0.0);
  EXPECT_EQ(estimate.hard_search_s, 0.0);
}

TEST(EstimateGrowth, CountsTreesOfBothRounds) {
  const std::vector<LabelledFrame> frames = people(20);
  TrainOptions options;
  options.trees = 4;
  options.hard_trees = 0;
  const double without = estimate_growth(frames, paper_body(), 20000, options, 1).evaluations;
  options.hard_trees = 2;
  EXPECT_GE(estimate_growth(frames, paper_body(), 20000, options, 1).evaluations, 1.5 * without);
}

TEST(EstimateGrowth, RefusesFramesWithoutReadings) {
  std::vector<LabelledFrame> frames = people(1);
  frames[0].frame.depth.fill(0);
  EXPECT_THROW(estimate_growth(frames, paper_body(), 1000, {}, 1), Error);
}

}  // namespace
}  // namespace vesalius
