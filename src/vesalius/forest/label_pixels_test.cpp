#include "vesalius/forest/label_pixels.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/base/random.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"
#include "vesalius/forest/background_gate.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/forest/tree_walk.h"

namespace vesalius {
namespace {

const Camera kCamera{64, 48, 60.F, 60.F, 31.5F, 23.5F};

Forest empty_forest(bool background) {
  Forest forest;
  forest.body = paper_body();
  forest.has_background = background;
  forest.convention.clip_mm = 800;
  return forest;
}

Tree leaf_tree(TreeLeaf leaf) { return {{}, {leaf}, {}}; }

TreeLeaf random_leaf(Random& random, int classes) {
  TreeLeaf leaf;
  int left = 255;
  for (std::size_t k = 0; k < TreeLeaf::kClasses && left > 0; ++k) {
    leaf.label[k] = static_cast<std::uint8_t>((random.below(5) + 5 * k) % static_cast<unsigned>(classes));
    leaf.probability[k] = static_cast<std::uint8_t>(1 + random.below(static_cast<std::uint32_t>(left)));
    left -= leaf.probability[k];
  }
  return leaf;
}

/// Returns a complete tree of `levels` with children after parents.
Tree random_tree(Random& random, int levels, int classes) {
  Tree tree;
  const int nodes = (1 << levels) - 1;
  for (int i = 0; i < nodes; ++i) {
    TreeNode node;
    const auto offset = [&] { return static_cast<std::int16_t>(static_cast<int>(random.below(201)) - 100); };
    node.du1 = offset();
    node.dv1 = offset();
    node.du2 = offset();
    node.dv2 = offset();
    node.threshold_mm = static_cast<std::int16_t>(static_cast<int>(random.below(400)) - 200);
    node.left = 2 * i + 1 < nodes ? 2 * i + 1 : ~(2 * i + 1 - nodes);
    node.right = 2 * i + 2 < nodes ? 2 * i + 2 : ~(2 * i + 2 - nodes);
    tree.nodes.push_back(node);
  }
  for (int i = 0; i <= nodes; ++i) tree.leaves.push_back(random_leaf(random, classes));
  return tree;
}

DepthImage random_depth(Random& random, int width = kCamera.width, int height = kCamera.height) {
  DepthImage depth(width, height);
  for (auto& z : depth) z = random.below(8) == 0 ? 0 : static_cast<std::uint16_t>(500 + random.below(3000));
  return depth;
}

/// Computes eq. 1 and 2 plainly in floating point.
std::vector<int> plain_sums(const Forest& forest, const DepthImage& depth, int u, int v) {
  std::vector<int> sums(static_cast<std::size_t>(forest.class_count()), 0);
  const FeatureConvention& c = forest.convention;
  const double z = depth(u, v);
  for (const Tree& tree : forest.trees) {
    int at = 0;
    while (at >= 0) {
      const TreeNode& n = tree.nodes[at];
      const auto read = [&](int du, int dv) {
        const double step = 1000.0 * c.offset_unit / c.reference_focal_px / z;
        const int pu = u + static_cast<int>(std::floor(du * step * kCamera.fx + 0.5));
        const int pv = v + static_cast<int>(std::floor(dv * step * kCamera.fy + 0.5));
        double d = depth.contains(pu, pv) ? depth(pu, pv) : c.outside_mm;
        if (d == 0) d = c.hole_mm;
        return std::clamp(d, z - c.clip_mm, z + c.clip_mm);
      };
      at = read(n.du1, n.dv1) - read(n.du2, n.dv2) <= n.threshold_mm ? n.left : n.right;
    }
    const TreeLeaf& leaf = tree.leaves[~at];
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) sums[leaf.label[k]] += leaf.probability[k];
  }
  return sums;
}

TEST(ForestLabeller, AgreesWithThePlainDefinition) {
  Random random(7);
  Forest forest = empty_forest(true);
  for (int t = 0; t < 3; ++t) forest.trees.push_back(random_tree(random, 7, forest.class_count()));
  const ForestLabeller labeller(forest);
  const DepthImage depth = random_depth(random);
  const Posteriors posteriors = labeller.label(depth_frame(depth, kCamera));
  long differing = 0;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const std::uint16_t* sums = posteriors.at(u, v);
      const std::vector<int> mine(sums, sums + posteriors.classes);
      if (depth(u, v) == 0) {
        EXPECT_THAT(mine, testing::Each(0));
      } else if (mine != plain_sums(forest, depth, u, v)) {
        ++differing;
      }
    }
  }
  // For a probe on the border of two pixels, fixed point may round differently.
  EXPECT_LE(differing, 3072 / 200);
}

/// Computes eq. 2 by walking one pixel after the other.
std::vector<std::uint16_t> walked_sums(const Forest& forest, const DepthImage& depth, const Camera& camera) {
  const auto classes = static_cast<std::size_t>(forest.class_count());
  std::vector<std::uint16_t> sums(depth.size() * classes, 0);
  const OffsetScaler scaler(forest.convention, camera);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) == 0) continue;
      const std::size_t pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(depth.width()) + u;
      for (const Tree& tree : forest.trees) {
        const TreeLeaf& leaf = walk(tree, depth, forest.convention, scaler.at(depth(u, v)), u, v);
        for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
          if (leaf.probability[k] != 0) sums[pixel * classes + leaf.label[k]] += leaf.probability[k];
        }
      }
    }
  }
  return sums;
}

// Labels: threads
TEST(ForestLabeller, SumsTheLeavesOfThePlainWalkForAnySizeAndThreads) {
  Random random(17);
  for (const bool background : {false, true}) {
    Forest forest = empty_forest(background);
    for (int t = 0; t < 3; ++t) forest.trees.push_back(random_tree(random, 6, forest.class_count()));
    forest.trees.push_back(leaf_tree({{3, 200, 4, 0}, {100, 0, 50, 0}}));  // an unused slot may have any label
    const ForestLabeller labeller(forest);
    for (const auto& [width, height] : {std::pair{0, 0}, std::pair{1, 1}, std::pair{53, 31}, std::pair{16000, 2}}) {
      const DepthImage depth = random_depth(random, width, height);
      const Camera camera{width, height, 60.F, 50.F, 0.F, 0.F};
      const std::vector<std::uint16_t> expected = walked_sums(forest, depth, camera);
      for_threads({1, 3}, [&] {
        EXPECT_EQ(labeller.label(depth_frame(depth, camera)).sums, expected) << camera.width << 'x' << camera.height;
      });
    }
  }
}

TEST(ForestLabeller, AveragesTheTrees) {
  Forest forest = empty_forest(false);
  forest.trees.push_back(leaf_tree({{4, 9, 0, 0}, {155, 100, 0, 0}}));
  forest.trees.push_back(leaf_tree({{9, 0, 0, 0}, {255, 0, 0, 0}}));
  const Posteriors p = ForestLabeller(forest).label(depth_frame(DepthImage(64, 48, 2000), kCamera));
  EXPECT_EQ(p.whole, 2 * 255);
  EXPECT_EQ(p.at(5, 5)[4], 155);
  EXPECT_EQ(p.at(5, 5)[9], 355);
  EXPECT_EQ(p.at(5, 5)[0], 0);
}

// Labels: threads
TEST(ForestLabeller, GivesTheSameBytesForAnyNumberOfThreads) {
  Random random(3);
  Forest forest = empty_forest(true);
  forest.trees.push_back(random_tree(random, 8, forest.class_count()));
  const ForestLabeller labeller(forest);
  const DepthImage depth = random_depth(random);
  std::vector<std::vector<std::uint16_t>> results;
  for_threads({1, 2, 8}, [&] { results.push_back(labeller.label(depth_frame(depth, kCamera)).sums); });
  EXPECT_THAT(results, testing::Each(results[0]));
}

/// Returns a forest that finds background in one half of the range of depths and parts in the other.
Forest forest_by_depth(Random& random) {
  Forest forest = empty_forest(true);
  for (int t = 0; t < 2; ++t) {
    Tree tree;
    TreeNode node;  // compares the reading with a probe far to the right
    node.du2 = 100;
    node.threshold_mm = 0;
    node.left = ~0;
    node.right = ~1;
    tree.nodes = {node};
    tree.leaves = {random_leaf(random, 25), {{25, 0, 0, 0}, {255, 0, 0, 0}}};
    forest.trees.push_back(tree);
  }
  return forest;
}

// Labels: threads
TEST(ForestLabeller, LeavesOutOnlyCertainBackgroundByItsGate) {
  Random random(31);
  const ForestLabeller labeller(forest_by_depth(random));
  const int background = 25;
  DepthImage depth(97, 61);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const int mm = u < 50 ? 3000 + 30 * (u % 9) : 1500 + 200 * static_cast<int>(random.below(3));
      depth(u, v) = random.below(9) == 0 ? 0 : static_cast<std::uint16_t>(mm);
    }
  }
  const Camera camera{97, 61, 60.F, 60.F, 48.F, 30.F};
  const Posteriors whole = labeller.label(depth_frame(depth, camera));
  int taken = 0;
  for_threads({1, 3}, [&] {
    Posteriors gated = whole;
    std::ranges::fill(gated.sums, std::uint16_t{7});  // whatever was there before
    labeller.label_into(depth_frame(depth, camera), 1.F, gated);
    const BackgroundGate gate(depth, whole, 1.F);
    std::vector<std::uint8_t> shut(97);
    for (int v = 0; v < depth.height(); ++v) {
      gate.row(v, shut.data());
      for (int u = 0; u < depth.width(); ++u) {
        const std::uint16_t* found = gated.at(u, v);
        if (std::equal(found, found + whole.classes, whole.at(u, v))) continue;
        ++taken;
        ASSERT_EQ(shut[u], 1) << u << ' ' << v;
        ASSERT_EQ(found[background], 510) << "taken over from where the forest is sure";
      }
    }
  });
  EXPECT_GT(taken, 20) << "somewhere the forest alone thinks otherwise";
}

TEST(ForestLabeller, RefusesPicturesOfMoreThan16000PixelsASide) {
  Forest forest = empty_forest(false);
  forest.trees.push_back(leaf_tree({{1, 0, 0, 0}, {255, 0, 0, 0}}));
  const ForestLabeller labeller(forest);
  for (const auto& [width, height] : {std::pair{16001, 1}, std::pair{1, 16001}}) {
    EXPECT_THROW(labeller.label(depth_frame(DepthImage(width, height), {width, height, 60.F, 50.F, 0.F, 0.F})), Error);
  }
}

TEST(ForestLabeller, RefusesAnInconsistentForest) {
  Forest forest = empty_forest(false);
  forest.trees.push_back(leaf_tree({{25, 0, 0, 0}, {255, 0, 0, 0}}));  // class 25 would be the background
  EXPECT_THROW(ForestLabeller{forest}, Error);
}

/// The posteriors of a 3x3 picture with three parts and background, from one tree.
class ChooseLabels : public testing::Test {
 protected:
  Posteriors posteriors{3, 3, 4, 255, std::vector<std::uint16_t>(36, 0)};
  DepthImage depth{3, 3, 1000};
  LabelOptions options;

  void set(int u, int v, std::array<std::uint16_t, 4> sums) { std::ranges::copy(sums, posteriors.at(u, v)); }
  void set_all(std::array<std::uint16_t, 4> sums) {
    for (int v = 0; v < 3; ++v) {
      for (int u = 0; u < 3; ++u) set(u, v, sums);
    }
  }
  LabelImage choose(const Mask* prior = nullptr) const { return choose_labels(posteriors, depth, {3, prior}, options); }
};

TEST_F(ChooseLabels, TakesTheLikeliest) {
  set_all({10, 200, 0, 40});
  set(1, 1, {10, 20, 0, 225});
  depth(0, 0) = 0;
  const LabelImage labels = choose();
  EXPECT_EQ(labels(2, 2), 1);
  EXPECT_EQ(labels(1, 1), kBackground);
  EXPECT_EQ(labels(0, 0), kBackground);
}

TEST_F(ChooseLabels, GivesUncertainPixelsTheLabelOfTheirNeighbours) {
  set_all({0, 0, 255, 0});
  set(1, 1, {100, 0, 95, 0});  // 0.02 apart, so uncertain
  EXPECT_EQ(choose()(1, 1), 2);
  set(1, 1, {140, 0, 95, 0});  // 0.18 apart, so certain
  EXPECT_EQ(choose()(1, 1), 0);
  set(1, 1, {100, 99, 0, 0});  // the neighbours' label is not among the best
  EXPECT_EQ(choose()(1, 1), 0);
}

TEST_F(ChooseLabels, WeighsTheBackground) {
  set_all({120, 0, 0, 100});
  EXPECT_EQ(choose()(1, 1), 0);
  options.background_weight = 2.F;
  EXPECT_EQ(choose()(1, 1), kBackground);
}

TEST_F(ChooseLabels, GivesBackgroundOnlyOutsideItsBox) {
  set_all({10, 200, 0, 40});
  set(1, 2, {100, 99, 0, 0});  // uncertain, so its neighbours decide, except those outside the box
  const LabelImage whole = choose();
  const Box box{1, 1, 2, 2};
  const LabelImage labels = choose_labels(posteriors, depth, {3, nullptr, &box}, options);
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 3; ++u) {
      EXPECT_EQ(labels(u, v), u >= 1 && v >= 1 ? whole(u, v) : kBackground) << u << ' ' << v;
    }
  }
}

TEST_F(ChooseLabels, TakesSettledPixelsAsBackgroundUnlessThePriorDisagrees) {
  set_all({0, 200, 0, 40});
  posteriors.settled = Mask(3, 3, 0);
  posteriors.settled(1, 1) = posteriors.settled(2, 1) = 1;
  EXPECT_EQ(choose()(1, 1), kBackground);
  EXPECT_EQ(choose()(0, 1), 1);
  Mask prior(3, 3, 0);
  prior(1, 1) = 1;
  const LabelImage labels = choose(&prior);
  EXPECT_EQ(labels(1, 1), 1);
  EXPECT_EQ(labels(2, 1), kBackground);
}

TEST_F(ChooseLabels, LetsThePriorDecideAboutTheBackground) {
  set_all({0, 30, 10, 215});
  Mask prior(3, 3, 0);
  prior(1, 1) = 1;
  const LabelImage labels = choose(&prior);
  EXPECT_EQ(labels(1, 1), 1);
  EXPECT_EQ(labels(0, 1), kBackground);
}

/// Returns a forest of random trees whose leaves have random logits.
Forest forest_with_logits(Random& random) {
  Forest forest = empty_forest(true);
  for (int t = 0; t < 3; ++t) forest.trees.push_back(random_tree(random, 4, 26));
  forest.logit_unit = 0.03F;
  forest.headings = 8;
  const LogitLayout layout(forest.body, true, 8);
  for (Tree& tree : forest.trees) {
    tree.logits.resize(tree.leaves.size() * static_cast<std::size_t>(layout.size()));
    for (std::int8_t& logit : tree.logits) logit = static_cast<std::int8_t>(static_cast<int>(random.below(256)) - 128);
  }
  return forest;
}

TEST(ForestLabeller, ReadsTheLogitsOfTheLeavesThatPixelsReach) {
  Random random(21, 0);
  const Forest forest = forest_with_logits(random);
  const LogitLayout layout(forest.body, true, 8);
  const DepthImage depth = random_depth(random);
  const ForestLabeller labeller(forest);
  const Posteriors posteriors = labeller.label(depth_frame(depth, kCamera));
  ASSERT_EQ(posteriors.headings, 8);
  const OffsetScaler scaler(forest.convention, kCamera);
  LogitReader reader(layout, forest.logit_unit, 3);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) == 0) {
        EXPECT_EQ(posteriors.at(u, v)[0], 0);
        continue;
      }
      std::vector<std::vector<std::int8_t>> rows;
      std::vector<const std::int8_t*> leaves;
      for (const Tree& tree : forest.trees) {
        const TreeLeaf* leaf = &walk(tree, depth, forest.convention, scaler.at(depth(u, v)), u, v);
        const auto at = static_cast<std::size_t>(leaf - tree.leaves.data());
        std::vector<std::int8_t>& row = rows.emplace_back(reader.padded(), 0);
        std::copy_n(tree.logits.data() + at * layout.size(), layout.size(), row.data());
        leaves.push_back(row.data());
      }
      std::vector<std::uint16_t> expected(26), turns(24);
      reader.read(leaves.data(), expected.data(), turns.data());
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), posteriors.at(u, v)));
      EXPECT_TRUE(std::equal(turns.begin(), turns.end(), posteriors.turns_at(u, v)));
    }
  }
}

TEST(ForestLabeller, RefusesLogitsThatDoNotFitTheForest) {
  Random random(22, 0);
  const Forest good = forest_with_logits(random);
  EXPECT_NO_THROW(check(good));
  Forest forest = good;
  forest.headings = 7;
  EXPECT_THROW(check(forest), Error);
  forest = good;
  forest.trees[1].logits.clear();
  EXPECT_THROW(check(forest), Error);
  forest = good;
  forest.logit_unit = 0.F;
  EXPECT_THROW(check(forest), Error);
  forest = good;
  forest.logit_unit = -1.F;
  EXPECT_THROW(check(forest), Error);
  forest = good;
  forest.facing = {3, 25, {1.F, 2.F}};
  EXPECT_THROW(check(forest), Error);
}

}  // namespace
}  // namespace vesalius
