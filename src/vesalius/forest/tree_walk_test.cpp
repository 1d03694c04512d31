#include "vesalius/forest/tree_walk.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr Camera kCamera{64, 48, 50.F, 60.F, 31.5F, 23.5F};

DepthImage random_depth(std::uint64_t seed) {
  Random random(seed);
  DepthImage depth(kCamera.width, kCamera.height);
  for (std::uint16_t& d : depth) d = random.below(4) == 0 ? 0 : static_cast<std::uint16_t>(500 + random.below(4000));
  return depth;
}

/// Computes eq. 1 in double precision. `sure` becomes false if rounding could give either result.
double exact_feature(const DepthImage& depth, const FeatureConvention& c, int u, int v, const TreeNode& n, bool& sure) {
  const double z_m = depth(u, v) / 1000.0;
  const auto read = [&](int du, int dv) {
    const double pu = u + du * static_cast<double>(c.offset_unit) * kCamera.fx / c.reference_focal_px / z_m;
    const double pv = v + dv * static_cast<double>(c.offset_unit) * kCamera.fy / c.reference_focal_px / z_m;
    for (const double p : {pu, pv}) sure = sure && std::abs(p - std::floor(p) - 0.5) > 0.02;
    const int iu = static_cast<int>(std::floor(pu + 0.5));
    const int iv = static_cast<int>(std::floor(pv + 0.5));
    double mm = c.outside_mm;
    if (depth.contains(iu, iv)) mm = depth(iu, iv) != 0 ? depth(iu, iv) : c.hole_mm;
    return c.clip_mm == 0 ? mm : std::clamp(mm, depth(u, v) - 1.0 * c.clip_mm, depth(u, v) + 1.0 * c.clip_mm);
  };
  return read(n.du1, n.dv1) - read(n.du2, n.dv2);
}

TEST(TreeWalk, ComputesEquationOne) {
  Random random(1);
  const FeatureConvention conventions[] = {
      {}, {.offset_unit = 1.F, .reference_focal_px = 640.F, .hole_mm = 9000, .outside_mm = 8000}, {.clip_mm = 500}};
  int compared = 0;
  for (const FeatureConvention& convention : conventions) {
    const DepthImage depth = random_depth(7);
    const OffsetScaler scaler(convention, kCamera);
    const auto offset = [&] { return static_cast<std::int16_t>(static_cast<int>(random.below(400)) - 200); };
    for (int i = 0; i < 3000; ++i) {
      const int u = static_cast<int>(random.below(64));
      const int v = static_cast<int>(random.below(48));
      if (depth(u, v) == 0) continue;
      const TreeNode node{.du1 = offset(), .dv1 = offset(), .du2 = offset(), .dv2 = offset()};
      bool sure = true;
      const double expected = exact_feature(depth, convention, u, v, node, sure);
      if (!sure) continue;
      ++compared;
      EXPECT_EQ(feature_mm(depth, convention, scaler.at(depth(u, v)), u, v, node), expected);
    }
  }
  EXPECT_GT(compared, 4000);
}

TEST(TreeWalk, ReadsHolesAndTheOutsideByTheConvention) {
  DepthImage depth(4, 4, 1000);
  depth(2, 1) = 0;
  const FeatureConvention convention{.hole_mm = 7777, .outside_mm = 8888};
  EXPECT_EQ(probe_mm(depth, convention, 2, 1), 7777);
  EXPECT_EQ(probe_mm(depth, convention, -1, 1), 8888);
  EXPECT_EQ(probe_mm(depth, convention, 1, 4), 8888);
  EXPECT_EQ(probe_mm(depth, convention, 1, 3), 1000);
}

TEST(TreeWalk, KeepsTheFurthestProbeOfTheNearestPixelInRange) {
  const DepthImage depth(2, 2, 1);
  const Camera wide{2, 2, 1e6F, 1e6F, 0.F, 0.F};
  const FeatureConvention convention;
  const OffsetScaler scaler(convention, wide);
  const TreeNode node{.du1 = kMaxOffset, .dv1 = -kMaxOffset, .du2 = -kMaxOffset, .dv2 = kMaxOffset};
  EXPECT_EQ(feature_mm(depth, convention, scaler.at(1), 1, 1, node), 0);
}

TEST(TreeWalk, GoesLeftAtTheThreshold) {
  DepthImage depth(3, 1, 1000);
  depth(2, 0) = 1100;
  const FeatureConvention convention;
  Tree tree;
  tree.leaves.resize(2);
  for (const auto& [threshold, leaf] : {std::pair<int, int>{99, 1}, {100, 0}, {101, 0}}) {
    tree.nodes = {{.du1 = 1, .threshold_mm = static_cast<std::int16_t>(threshold), .left = ~0, .right = ~1}};
    EXPECT_EQ(&walk(tree, depth, convention, {65536, 65536}, 1, 0), &tree.leaves[leaf]);
  }
}

TEST(TreeWalk, EndsInTheLeafOfATreeWithoutNodes) {
  Tree tree;
  tree.leaves.resize(1);
  EXPECT_EQ(&walk(tree, DepthImage(1, 1, 1000), {}, {1, 1}, 0, 0), tree.leaves.data());
}

}  // namespace
}  // namespace vesalius
