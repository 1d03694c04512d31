#include "train/samples/sample_accuracy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>

#include "capsule/capsule_person.h"
#include "train/grow_forest.h"
#include "vesalius/base/random.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr Camera kCamera{80, 60, 66.F, 66.F, 39.5F, 29.5F};

LabelledFrame person_at(int i) {
  Random random(11, static_cast<std::uint64_t>(i));
  CapsulePerson person;
  person.pose.yaw = static_cast<float>(random.uniform(-0.5, 0.5));
  person.pose.l_arm.raise = static_cast<float>(random.uniform(0.2, 2.0));
  CapsuleScene scene;
  scene.people = {person};
  LabelledFrame frame = render(scene, kCamera, paper_body());
  add_sensor_noise(frame.frame, static_cast<std::uint64_t>(i));
  return frame;
}

/// A set with held-out frames, those frames, and a small forest.
class SampleAccuracyTest : public testing::Test {
 protected:
  void SetUp() override {
    options_.sample.held_out_share = 0.1F;
    options_.grow.leaf.max_depth = 8;
    set_ = std::make_unique<TrainingSet>(paper_body(), training_convention(options_), options_.sample, 1);
    for (int i = 0; i < 40; ++i) frames_.push_back(person_at(i));
    for (const LabelledFrame& frame : frames_) set_->add(frame);
    forest_ = set_->untrained_forest();
    for (int t = 0; t < 3; ++t) forest_.trees.push_back(grow_tree(*set_, options_.grow, t));
  }

  TrainOptions options_;
  std::vector<LabelledFrame> frames_;
  std::unique_ptr<TrainingSet> set_;
  Forest forest_;
};

TEST_F(SampleAccuracyTest, AgreesWithTheDetectorsLabeller) {
  const ForestLabeller labeller(forest_);
  Confusion all(26), parts(25);
  std::map<std::uint32_t, Posteriors> of_frame;
  for (const TrainingSample& sample : set_->held_out()) {
    const Frame& frame = frames_[sample.frame].frame;
    if (!of_frame.contains(sample.frame)) of_frame[sample.frame] = labeller.label(frame);
    const Posteriors& posteriors = of_frame[sample.frame];
    const std::uint16_t* sums = posteriors.at(sample.u, sample.v);
    ++all.at(sample.label, static_cast<int>(std::max_element(sums, sums + 26) - sums));
    if (sample.label < 25) ++parts.at(sample.label, static_cast<int>(std::max_element(sums, sums + 25) - sums));
  }
  HeldOutVotes votes(*set_);
  for (const Tree& tree : forest_.trees) votes.add(tree);
  EXPECT_EQ(votes.accuracy().all.counts, all.counts);
  EXPECT_EQ(votes.accuracy().parts.counts, parts.counts);
}

// Labels: threads
TEST_F(SampleAccuracyTest, IsTheSameForAnyNumberOfThreads) {
  const auto counts = [&](int threads) {
    const ThreadLimit limit(threads);
    HeldOutVotes votes(*set_);
    for (const Tree& tree : forest_.trees) votes.add(tree);
    return votes.accuracy().all.counts;
  };
  EXPECT_EQ(counts(1), counts(4));
}

TEST_F(SampleAccuracyTest, EndsWithTheForestByTrees) {
  const std::vector<AccuracyPoint> points = accuracy_by_trees(forest_, *set_);
  ASSERT_EQ(points.size(), 3U);
  HeldOutVotes votes(*set_);
  votes.add(forest_.trees[0]);
  EXPECT_EQ(points[0].parts_only, votes.accuracy().parts_only());
  votes.add(forest_.trees[1]);
  votes.add(forest_.trees[2]);
  EXPECT_EQ(points[2].with_background, votes.accuracy().with_background());
  EXPECT_GT(points[2].parts_only, 0.3) << "chance is 0.04";
}

TEST_F(SampleAccuracyTest, BeginsWithOneGuessAndEndsWithTheForestByLevels) {
  const std::vector<AccuracyPoint> points = accuracy_by_level(forest_, *set_);
  int deepest = 0;
  for (const Tree& tree : forest_.trees) deepest = std::max(deepest, depth(tree));
  ASSERT_EQ(points.size(), static_cast<std::size_t>(deepest) + 1);
  EXPECT_NEAR(points.front().parts_only, 1.0 / 25, 0.01) << "the most frequent part for every sample";
  // The model's leaves keep four classes in 1/255; the curve keeps all of them exactly.
  EXPECT_NEAR(points.back().parts_only, accuracy_by_trees(forest_, *set_).back().parts_only, 0.03);
  EXPECT_GT(points.back().parts_only, points[3].parts_only);
}

TEST(Confusion, AveragesRecallOverPartsThatOccur) {
  SampleAccuracy accuracy{Confusion(4), Confusion(3)};
  accuracy.all.at(0, 0) = 3;  // of 4
  accuracy.all.at(0, 3) = 1;
  accuracy.all.at(1, 1) = 1;  // of 2; part 2 does not occur, class 3 is the background
  accuracy.all.at(1, 2) = 1;
  accuracy.all.at(3, 3) = 100;
  EXPECT_DOUBLE_EQ(accuracy.with_background(), (0.75 + 0.5) / 2);
  EXPECT_EQ(accuracy.all.row_sum(0), 4U);
  EXPECT_EQ(accuracy.parts_only(), 0.0);
  EXPECT_EQ(accuracy.all.recall(2), 0.0);
}

}  // namespace
}  // namespace vesalius
