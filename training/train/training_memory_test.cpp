#include "train/training_memory.h"

#include <gtest/gtest.h>

#include "capsule/capsule_person.h"
#include "train/samples/frame_store.h"

namespace vesalius {
namespace {

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30U;

TEST(TrainingMemory, FitsAHundredThousandFramesInSixteenGigabytes) {
  const DepthImage room = render({}, {320, 240, 262.F, 262.F, 159.5F, 119.5F}, paper_body()).frame.depth;
  const FrameGroup group{100000, FrameStore::frame_bytes(room), false};
  const TrainingMemory memory = training_memory({&group, 1}, {}, 26);
  EXPECT_EQ(memory.depth, 100000 * group.frame_bytes);
  EXPECT_LT(memory.total(2), 16'000'000'000U);
}

TEST(TrainingMemory, GrowsWithFramesPixelsAndTrees) {
  const FrameGroup some{1000, 100000, false};
  const FrameGroup more{2000, 100000, false};
  TrainOptions dense;
  dense.sample.pixels_per_frame = 1000;
  const TrainingMemory base = training_memory({&some, 1}, {}, 26);
  EXPECT_GT(training_memory({&more, 1}, {}, 26).total(1), 1.9 * static_cast<double>(base.total(1)));
  EXPECT_GT(training_memory({&some, 1}, dense, 26).samples, base.samples);
  EXPECT_EQ(base.total(3) - base.total(1), 2 * base.tree);
}

TEST(TrainingMemory, IsAnUpperBoundOfASetsMemory) {
  CapsuleScene scene;
  scene.people = {CapsulePerson{}};
  const LabelledFrame person = render(scene, {160, 120, 131.F, 131.F, 79.5F, 59.5F}, paper_body());
  const LabelledFrame empty = render({}, {160, 120, 131.F, 131.F, 79.5F, 59.5F}, paper_body());
  const TrainOptions options;
  TrainingSet set(paper_body(), training_convention(options), options.sample, 1);
  for (int i = 0; i < 90; ++i) set.add(person);
  for (int i = 0; i < 10; ++i) set.add(empty);
  const FrameGroup group{100, FrameStore::frame_bytes(person.frame.depth), false};
  const TrainingMemory memory = training_memory({&group, 1}, options, set.class_count());
  EXPECT_GE(memory.depth, set.frames().bytes());
  EXPECT_GE(memory.depth + memory.samples, set.bytes());
  EXPECT_NEAR(static_cast<double>(expected_samples({&group, 1}, options)), static_cast<double>(set.samples().size()),
              0.1 * static_cast<double>(set.samples().size()));
}

TEST(TrainingMemory, CountsLearningLeavesAfterGrowing) {
  const FrameGroup group{10000, 100000, false};
  TrainOptions options;
  const TrainingMemory grown = training_memory({&group, 1}, options, 26);
  EXPECT_EQ(grown.leaves, 0U);
  options.leaves.rounds = 10;
  const TrainingMemory learned = training_memory({&group, 1}, options, 26);
  EXPECT_GT(learned.leaves, learned.tree);
  EXPECT_EQ(learned.total(1), learned.depth + learned.samples + learned.leaves);
  options.leaves.headings = 0;
  EXPECT_LT(training_memory({&group, 1}, options, 26).leaves, learned.leaves);
}

TEST(TrainingFit, IsTheLargestThatFits) {
  const FrameGroup group{40000, 300000, false};
  const TrainOptions options;
  const std::uint64_t bytes = 8 * kGiB;
  ASSERT_GT(training_memory({&group, 1}, options, 26).total(1), bytes);
  const TrainingFit fit = training_fit({&group, 1}, options, 26, bytes);
  const auto total_of = [&](double share) {
    const FrameGroup fewer{static_cast<std::uint64_t>(40000 * share), 300000, false};
    return training_memory({&fewer, 1}, options, 26).total(1);
  };
  EXPECT_LE(total_of(fit.frame_share), bytes);
  EXPECT_GT(total_of(fit.frame_share + 0.01), bytes);
  EXPECT_EQ(fit.pixels, 0) << "depth alone is too much";
}

TEST(TrainingFit, ReducesPixelsIfDepthFits) {
  const FrameGroup group{40000, 20000, false};
  TrainOptions options;
  options.sample.pixels_per_frame = 20000;
  const TrainingFit fit = training_fit({&group, 1}, options, 26, 8 * kGiB);
  ASSERT_GT(fit.pixels, 0);
  options.sample.pixels_per_frame = fit.pixels;
  EXPECT_LE(training_memory({&group, 1}, options, 26).total(1), 8 * kGiB);
  options.sample.pixels_per_frame = fit.pixels + 1;
  EXPECT_GT(training_memory({&group, 1}, options, 26).total(1), 8 * kGiB);
}

}  // namespace
}  // namespace vesalius
