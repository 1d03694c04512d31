#include "train/samples/walk_samples.h"

#include <gtest/gtest.h>

#include "train/grow_tree.h"
#include "train/test_training.h"

namespace vesalius {
namespace {

class FindLeaves : public testing::Test {
 protected:
  /// Returns a set with so many pixels of each frame, which decide whether frames are unpacked.
  static TrainingSet set_of(int pixels, std::uint16_t hole_mm) {
    TrainOptions options;
    options.sample.pixels_per_frame = pixels;
    FeatureConvention convention = training_convention(options);
    convention.hole_mm = hole_mm;
    TrainingSet set(paper_body(), convention, options.sample, 1);
    for (const LabelledFrame& frame : test::noisy_frames(6, 3.1)) set.add(frame);
    return set;
  }

  /// Returns trees that samples of `set` walk down a few levels; the last one is a leaf.
  static std::vector<Tree> trees_of(const TrainingSet& set) {
    GrowTreeOptions options;
    options.leaf.min_samples = 2;
    options.leaf.max_depth = 9;
    return {grow_tree(set, options, 0), grow_tree(set, options, 1), Tree{{}, {TreeLeaf{}}, {}}};
  }
};

TEST_F(FindLeaves, AgreesWithTheWalkOfSingleSamples) {
  for (const int pixels : {20, 400}) {
    for (const std::uint16_t hole_mm : {std::uint16_t{0}, std::uint16_t{10000}}) {
      const TrainingSet set = set_of(pixels, hole_mm);
      std::vector<Tree> trees = trees_of(set);
      ASSERT_GT(trees[0].leaves.size(), 5U);
      const std::vector<const Tree*> asked{&trees[0], &trees[1], &trees[2]};
      const auto leaves = find_leaves(asked, set.frames(), set.samples());
      for (std::size_t t = 0; t < asked.size(); ++t) {
        ASSERT_EQ(leaves[t].size(), set.samples().size());
        for (std::size_t i = 0; i < leaves[t].size(); ++i) {
          ASSERT_EQ(leaves[t][i], leaf_of(trees[t], set.frames(), set.samples()[i])) << t << ' ' << i;
        }
      }
      for (Tree& tree : trees) tree.leaves.clear();
      EXPECT_EQ(find_leaves(asked, set.frames(), set.samples()), leaves);
    }
  }
}

TEST_F(FindLeaves, LeavesFramesThatAreNotWantedAtZero) {
  const TrainingSet set = set_of(400, 10000);
  const std::vector<Tree> trees = trees_of(set);
  const auto all = find_leaves({&trees[0]}, set.frames(), set.samples()).front();
  const auto odd = find_leaves({&trees[0]}, set.frames(), set.samples(), [](std::uint32_t f) { return f % 2 == 1; });
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(odd.front()[i], set.samples()[i].frame % 2 == 1 ? all[i] : 0U);
  }
}

}  // namespace
}  // namespace vesalius
