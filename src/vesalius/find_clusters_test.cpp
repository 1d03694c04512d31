#include "vesalius/find_clusters.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

const Camera kCamera{64, 48, 60.F, 60.F, 31.5F, 23.5F};

/// Returns options that keep every cluster, so that partitions can be compared.
ClusterOptions keep_all() {
  ClusterOptions o;
  o.min_area_cm2 = 0.F;
  o.min_pixels = 1;
  o.max_extent_scale = 10.F;
  return o;
}

class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  void join(int a, int b) { parent_[root(a)] = root(b); }

 private:
  std::vector<int> parent_;
};

std::set<std::set<int>> slow_partition(const LabelImage& labels, const DepthImage& depth, const ClusterOptions& o) {
  const int w = labels.width();
  UnionFind sets(labels.size());
  const auto point = [&](int i) {
    return kCamera.point(static_cast<float>(i % w), static_cast<float>(i / w), static_cast<float>(depth[i]) * 1e-3F);
  };
  const auto usable = [&](int u, int v) { return depth.contains(u, v) && depth(u, v) != 0 && labels(u, v) < 25; };
  for (int v = 0; v < labels.height(); ++v) {
    for (int u = 0; u < w; ++u) {
      for (const auto& [du, dv] : {std::pair{1, 0}, {0, 1}, {1, 1}, {-1, 1}}) {
        if (!usable(u, v) || !usable(u + du, v + dv) || labels(u, v) != labels(u + du, v + dv)) continue;
        const int a = v * w + u, b = (v + dv) * w + u + du;
        const float gap = o.max_gap_m + o.max_gap_per_z2 * point(a).z() * point(b).z();
        if ((point(a) - point(b)).norm() <= gap) sets.join(a, b);
      }
    }
  }
  std::map<int, std::set<int>> groups;
  for (int i = 0; i < static_cast<int>(labels.size()); ++i) {
    if (usable(i % w, i / w)) groups[sets.root(i)].insert(i);
  }
  std::set<std::set<int>> out;
  for (auto& [root, members] : groups) out.insert(members);
  return out;
}

TEST(FindClusters, AgreesWithUnionFind) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    LabelImage labels(64, 48);
    DepthImage depth(64, 48);
    for (auto& l : labels) l = random.below(7) == 0 ? kBackground : static_cast<std::uint8_t>(10 + random.below(2));
    for (auto& z : depth) z = random.below(9) == 0 ? 0 : static_cast<std::uint16_t>(1000 + random.below(120));
    const Clusters clusters = find_clusters(labels, depth, kCamera, paper_body(), keep_all());
    std::map<int, std::set<int>> groups;
    for (int i = 0; i < static_cast<int>(labels.size()); ++i) {
      const std::int32_t id = clusters.index[i];
      if (id >= 0) groups[id].insert(i);
    }
    std::set<std::set<int>> fast;
    for (auto& [id, members] : groups) {
      EXPECT_EQ(clusters.items[id].pixels, static_cast<int>(members.size()));
      EXPECT_EQ(clusters.items[id].first_pixel, *members.begin());
      fast.insert(members);
    }
    EXPECT_EQ(fast, slow_partition(labels, depth, keep_all())) << "seed " << seed;
  }
}

/// Paints a w x h rectangle of label 6 (any part l_...) at depth z with its top left at (u, v).
void paint(LabelImage& labels, DepthImage& depth, int u, int v, int w, int h, std::uint16_t z, std::uint8_t label = 6) {
  for (int y = v; y < v + h; ++y) {
    for (int x = u; x < u + w; ++x) {
      labels(x, y) = label;
      depth(x, y) = z;
    }
  }
}

TEST(FindClusters, MeasuresARectangle) {
  LabelImage labels(64, 48, kBackground);
  DepthImage depth(64, 48, 4000);
  paint(labels, depth, 22, 21, 20, 6, 1200);  // centred on the optical axis, with 20 mm per pixel
  const Clusters clusters = find_clusters(labels, depth, kCamera, paper_body(), keep_all());
  ASSERT_EQ(clusters.items.size(), 1U);
  const PartCluster& c = clusters.items[0];
  EXPECT_EQ(c.pixels, 120);
  EXPECT_NEAR(c.area_m2, 120 * 0.02 * 0.02, 1e-5);
  EXPECT_NEAR((c.centroid - Eigen::Vector3f(0.F, 0.F, 1.2F)).norm(), 0.0, 1e-4);
  EXPECT_NEAR(c.covariance(0, 0), 0.02 * 0.02 * (20 * 20 - 1) / 12.0, 1e-5);  // the variance of a row of points
  EXPECT_NEAR(c.covariance(1, 1), 0.02 * 0.02 * (6 * 6 - 1) / 12.0, 1e-5);
  EXPECT_NEAR(c.eigenvalues.x(), c.covariance(0, 0), 1e-6);
  EXPECT_NEAR(c.extent_m, 0.4, 0.001);
}

TEST(FindClusters, LimitsTheAreaOfPartsNotTheirPixels) {
  ClusterOptions options;
  options.min_area_cm2 = 20.F;
  options.min_pixels = 4;
  const auto found = [&](int side, std::uint16_t z) {
    LabelImage labels(64, 48, kBackground);
    DepthImage depth(64, 48, 9000);
    paint(labels, depth, 10, 10, side, side, z);
    return find_clusters(labels, depth, kCamera, paper_body(), options).items.size();
  };
  EXPECT_EQ(found(3, 600), 0U);   // 9 pixels of 1 cm^2
  EXPECT_EQ(found(5, 600), 1U);   // 25 cm^2
  EXPECT_EQ(found(3, 1200), 1U);  // the same 9 pixels at twice the distance: 36 cm^2
  EXPECT_EQ(found(1, 3000), 0U);  // 25 cm^2 again, but a single pixel
}

TEST(FindClusters, DropsPartsThatAreTooLong) {
  LabelImage labels(64, 48, kBackground);
  DepthImage depth(64, 48, 4000);
  const int knee = paper_body().find_part("l_knee");                          // up to 0.6 m
  paint(labels, depth, 4, 4, 35, 4, 1200, static_cast<std::uint8_t>(knee));   // 0.7 m
  paint(labels, depth, 4, 20, 25, 4, 1200, static_cast<std::uint8_t>(knee));  // 0.5 m
  const Clusters clusters = find_clusters(labels, depth, kCamera, paper_body(), {});
  ASSERT_EQ(clusters.items.size(), 1U);
  EXPECT_NEAR(clusters.items[0].extent_m, 0.5, 0.01);
  EXPECT_EQ(clusters.index(10, 5), -1);
  EXPECT_EQ(clusters.index(10, 21), 0);
}

TEST(FindClusters, WhatIsOutsideOfTheBoxIsNotThere) {
  Random random(5);
  LabelImage labels(64, 48, kBackground);
  DepthImage depth(64, 48, 4000);
  for (int i = 0; i < 40; ++i) {
    paint(labels, depth, int(random.below(56)), int(random.below(40)), 8, 8, 1000,
          static_cast<std::uint8_t>(random.below(4)));
  }
  const Box box{9, 7, 40, 30};
  LabelImage inside(64, 48, kBackground);
  for (int v = box.v; v < box.v + box.height; ++v) {
    std::copy_n(labels.row(v) + box.u, box.width, inside.row(v) + box.u);
  }
  const Clusters expected = find_clusters(inside, depth, kCamera, paper_body(), {});
  const Clusters found = find_clusters(labels, depth, kCamera, paper_body(), {}, box);
  ASSERT_GT(expected.items.size(), 3U);
  ASSERT_EQ(found.items.size(), expected.items.size());
  EXPECT_EQ(found.index, expected.index);
  for (std::size_t i = 0; i < found.items.size(); ++i) {
    EXPECT_EQ(found.items[i].first_pixel, expected.items[i].first_pixel);
    EXPECT_EQ(found.items[i].centroid, expected.items[i].centroid);
  }
}

TEST(FindClusters, SortsByLabelThenArea) {
  LabelImage labels(64, 48, kBackground);
  DepthImage depth(64, 48, 4000);
  paint(labels, depth, 2, 2, 6, 6, 1000, 9);
  paint(labels, depth, 20, 2, 8, 8, 1000, 9);
  paint(labels, depth, 40, 2, 6, 6, 1000, 4);
  const Clusters clusters = find_clusters(labels, depth, kCamera, paper_body(), {});
  ASSERT_EQ(clusters.items.size(), 3U);
  EXPECT_EQ(clusters.items[0].label, 4);
  EXPECT_EQ(clusters.items[1].pixels, 64);
  EXPECT_EQ(clusters.items[2].pixels, 36);
  EXPECT_EQ(clusters.index(22, 4), 1);
}

}  // namespace
}  // namespace vesalius
