#include "vesalius/search_skeletons.h"

#include <gmock/gmock.h>

#include <cmath>
#include <optional>
#include <set>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

/// Returns a six-part body: trunk - neck - head, trunk - left, trunk - right - hand.
BodyModel small_body() {
  BodyModel body;
  for (const char* name : {"trunk", "neck", "head", "left", "right", "hand"}) {
    BodyPart part;
    part.name = name;
    part.max_extent_m = 1.F;
    part.typical_area_m2 = 0.02F;
    part.mirror = body.part_count();
    body.parts.push_back(part);
  }
  body.links = {{0, 1, 0.2F, 0.1F}, {1, 2, 0.15F, 0.1F}, {0, 3, 0.3F, 0.1F}, {0, 4, 0.3F, 0.1F}, {4, 5, 0.2F, 0.1F}};
  body.roots = {1, 2};
  return body;
}

PartCluster cluster(int label, const Vector3f& centre, float area_m2 = 0.02F, float spread_m = 0.08F) {
  PartCluster c;
  c.label = label;
  c.centroid = centre;
  c.area_m2 = area_m2;
  c.pixels = 100;
  c.covariance = Matrix3f::Identity() * spread_m * spread_m;
  c.eigenvalues = Vector3f::Constant(spread_m * spread_m);
  return c;
}

/// Returns the places of the parts of a person at `at`.
std::vector<Vector3f> person_at(const Vector3f& at) {
  return {at,
          at + Vector3f(0.F, -0.2F, 0.F),
          at + Vector3f(0.F, -0.35F, 0.F),
          at + Vector3f(0.3F, 0.F, 0.F),
          at + Vector3f(-0.3F, 0.F, 0.F),
          at + Vector3f(-0.3F, 0.2F, 0.F)};
}

/// Computes the same likelihood by trying every assignment of clusters to parts.
class Exhaustive {
 public:
  Exhaustive(const std::vector<PartCluster>& clusters, const BodyModel& body, const SearchOptions& options)
      : clusters_(clusters), body_(body), options_(options) {}

  float best() {
    float best = 0.F;
    std::vector<int> roots = body_.roots;
    for (int part = 0; options_.any_root && part < body_.part_count(); ++part) roots.push_back(part);
    for (const int root : roots) {
      for (int i = 0; i < static_cast<int>(clusters_.size()); ++i) {
        if (clusters_[i].label != root) continue;
        std::vector<int> chosen(body_.parts.size(), -1);
        chosen[root] = i;
        best = std::max(best, try_parts(root, 0, chosen));
      }
    }
    return best;
  }

 private:
  float try_parts(int root, int part, std::vector<int>& chosen) {
    if (part == body_.part_count()) return value(root, chosen);
    if (part == root) return try_parts(root, part + 1, chosen);
    float best = try_parts(root, part + 1, chosen);
    for (int i = 0; i < static_cast<int>(clusters_.size()); ++i) {
      if (clusters_[i].label != part) continue;
      chosen[part] = i;
      best = std::max(best, try_parts(root, part + 1, chosen));
      chosen[part] = -1;
    }
    return best;
  }

  /// Returns the links from `part` to `root`, beginning at the part.
  std::vector<const BodyLink*> way(int part, int root, int from = -1) const {
    if (part == root) return {};
    for (const BodyLink& link : body_.links) {
      const int next = link.parent == part ? link.child : link.child == part ? link.parent : -1;
      if (next < 0 || next == from) continue;
      auto rest = way(next, root, part);
      if (next != root && rest.empty()) continue;
      rest.insert(rest.begin(), &link);
      return rest;
    }
    return {};
  }

  float value(int root, const std::vector<int>& chosen) const {
    float sum = 0.F;
    for (int part = 0; part < body_.part_count(); ++part) {
      const int me = chosen[part];
      if (me < 0) continue;
      sum += 1.F;  // every cluster of these tests has a feasible size
      if (part == root) continue;
      const auto links = way(part, root);
      const auto other_end = [](const BodyLink& l, int p) { return l.parent == p ? l.child : l.parent; };
      const int parent = other_end(*links[0], part);
      float error = 1e9F;
      if (chosen[parent] >= 0) {
        const float l = links[0]->length_m;
        error = distance(me, chosen[parent], l, l, links[0]->tolerance_m, 0.F);
      } else if (links.size() > 1 && chosen[other_end(*links[1], parent)] >= 0) {
        const float a = links[0]->length_m, b = links[1]->length_m;
        error = distance(me, chosen[other_end(*links[1], parent)], std::max(std::abs(a - b), (a + b) / 2.F), a + b,
                         std::max(links[0]->tolerance_m, links[1]->tolerance_m), (a + b) / 2.F);
      }
      if (error > options_.max_error) return 0.F;
      sum -= options_.error_weight * error * error;
    }
    return sum;
  }

  float distance(int i, int j, float low, float high, float tolerance, float hidden) const {
    const PartCluster &a = clusters_[i], &b = clusters_[j];
    const Vector3f line = b.centroid - a.centroid;
    const float d = line.norm();
    const Vector3f n = line / d;
    const float va = n.dot(a.covariance * n), vb = n.dot(b.covariance * n);
    const float off = d < low ? low - d : d > high ? d - high : 0.F;
    const float e = off / std::sqrt(tolerance * tolerance + options_.covariance_share * (va + vb));
    const float gap = d - std::sqrt(3.F * va) - std::sqrt(3.F * vb) - hidden;
    const float g = gap > 0.F ? gap / options_.gap_tolerance_m : 0.F;
    return std::sqrt(e * e + g * g);
  }

  const std::vector<PartCluster>& clusters_;
  const BodyModel& body_;
  const SearchOptions& options_;
};

void expect_what_exhaustive_search_finds(bool any_root) {
  const BodyModel body = small_body();
  SearchOptions options;
  options.any_root = any_root;
  options.min_parts = 1;
  options.max_mean_error = 100.F;
  options.max_total_error = 1000.F;
  int with_several_parts = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    std::vector<PartCluster> clusters;
    for (int part = 0; part < body.part_count(); ++part) {
      const auto copies = random.below(4);
      for (std::uint32_t k = 0; k < copies; ++k) {
        const Vector3f noise(static_cast<float>(random.normal(0, 0.12)), static_cast<float>(random.normal(0, 0.12)),
                             static_cast<float>(random.normal(0, 0.12)));
        clusters.push_back(cluster(part, person_at({0.F, 0.F, 2.F})[part] + noise));
      }
    }
    const std::vector<Skeleton> found = search_skeletons(clusters, body, options);
    const float best = Exhaustive(clusters, body, options).best();
    ASSERT_EQ(found.empty(), best == 0.F) << "seed " << seed;
    if (found.empty()) continue;
    EXPECT_NEAR(found[0].score, best, 1e-4) << "seed " << seed;
    with_several_parts += found[0].found >= 3 ? 1 : 0;
  }
  EXPECT_GT(with_several_parts, 30);  // most cases are not trivial
}

TEST(SearchSkeletons, AgreesWithExhaustiveSearch) { expect_what_exhaustive_search_finds(true); }

TEST(SearchSkeletons, AgreesWithExhaustiveSearchFromTheBodysRoots) { expect_what_exhaustive_search_finds(false); }

std::vector<PartCluster> people(const std::vector<Vector3f>& places) {
  std::vector<PartCluster> clusters;
  for (int part = 0; part < 6; ++part) {
    for (const Vector3f& at : places) clusters.push_back(cluster(part, person_at(at)[part]));
  }
  return clusters;
}

TEST(SearchSkeletons, GivesEachProposalToOnePerson) {
  const std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}, {1.F, 0.F, 2.F}, {0.5F, 0.F, 3.F}});
  const std::vector<Skeleton> found = search_skeletons(clusters, small_body(), {});
  ASSERT_EQ(found.size(), 3U);
  std::set<int> used;
  for (const Skeleton& s : found) {
    EXPECT_EQ(s.found, 6);
    for (const SkeletonPart& part : s.parts) EXPECT_TRUE(used.insert(part.cluster).second);
    // All parts belong to one person; nobody borrows a neighbour's hand.
    EXPECT_LT((s.parts[5].centre - s.parts[0].centre).norm(), 0.4F);
  }
}

TEST(SearchSkeletons, BridgesOneMissingPartButNotTwo) {
  std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}});
  std::erase_if(clusters,
                [](const PartCluster& c) { return c.label == 4; });  // without `right`, the hand is linked to the trunk
  std::vector<Skeleton> found = search_skeletons(clusters, small_body(), {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].parts[4].state, State::none);
  EXPECT_EQ(found[0].parts[5].state, State::observed);
  std::erase_if(clusters, [](const PartCluster& c) {
    return c.label == 0;
  });  // without the trunk as well, it is linked to nothing
  SearchOptions options;
  options.min_parts = 2;
  found = search_skeletons(clusters, small_body(), options);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].parts[5].state, State::none);
  EXPECT_EQ(found[0].parts[3].state, State::observed);  // `left` is linked to the neck
}

TEST(SearchSkeletons, SkipsNoMissingPartWithoutGrandparents) {
  std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}});
  SearchOptions options;
  options.grandparents = false;
  EXPECT_EQ(search_skeletons(clusters, small_body(), options).at(0).found, 6);
  std::erase_if(clusters, [](const PartCluster& c) { return c.label == 4; });
  const Skeleton without = search_skeletons(clusters, small_body(), options).at(0);
  EXPECT_EQ(without.parts[5].state, State::none);
  EXPECT_EQ(without.found, 4);
}

TEST(SearchSkeletons, RootsAtAFaceWhenTheNeckIsHidden) {
  std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}});
  std::erase_if(clusters, [](const PartCluster& c) { return c.label == 1; });
  const std::vector<Skeleton> found = search_skeletons(clusters, small_body(), {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].root, 2);
  EXPECT_EQ(found[0].found, 5);
}

TEST(SearchSkeletons, FindsAPersonWithoutHeadAndNeckUnlessRootedThere) {
  std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}});
  std::erase_if(clusters, [](const PartCluster& c) { return c.label == 1 || c.label == 2; });
  SearchOptions options;
  const std::vector<Skeleton> found = search_skeletons(clusters, small_body(), options);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].found, 4);
  options.any_root = false;
  EXPECT_TRUE(search_skeletons(clusters, small_body(), options).empty());
}

TEST(SearchSkeletons, RootsAFullyVisiblePersonInTheBody) {
  EXPECT_EQ(search_skeletons(people({{0.F, 0.F, 2.F}}), small_body(), {}).at(0).root, 1);
}

TEST(SearchSkeletons, RejectsByEveryAcceptanceParameter) {
  std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}});
  for (PartCluster& c : clusters) c.centroid *= 1.03F;  // a little too large
  const BodyModel body = small_body();
  const std::vector<Skeleton> found = search_skeletons(clusters, body, {});
  ASSERT_EQ(found.size(), 1U);
  ASSERT_GT(found[0].total_error, 0.F);
  EXPECT_NEAR(found[0].mean_error, found[0].total_error / static_cast<float>(found[0].found), 1e-6);
  SearchOptions options;
  options.max_total_error = found[0].total_error * 0.99F;
  EXPECT_TRUE(search_skeletons(clusters, body, options).empty());
  options = {};
  options.max_mean_error = found[0].mean_error * 0.99F;
  EXPECT_TRUE(search_skeletons(clusters, body, options).empty());
  options = {};
  options.min_parts = 7;
  EXPECT_TRUE(search_skeletons(clusters, body, options).empty());
}

TEST(SearchSkeletons, PrefersAPartOfFeasibleSize) {
  std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}});
  for (PartCluster& c : clusters) {
    if (c.label == 5) c.area_m2 = 0.001F;  // a sliver where the hand should be
  }
  clusters.push_back(cluster(5, person_at({0.F, 0.F, 2.F})[5] + Vector3f(0.F, 0.03F, 0.F)));
  const std::vector<Skeleton> found = search_skeletons(clusters, small_body(), {});
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].parts[5].cluster, static_cast<int>(clusters.size()) - 1);
}

TEST(SearchSkeletons, ExcusesADeviationByTheCovarianceAlongTheLine) {
  // The hand is a little too far away: a long hand reaches back to the arm, a ball does not.
  std::vector<PartCluster> clusters = people({{0.F, 0.F, 2.F}});
  PartCluster& hand = clusters.back();
  ASSERT_EQ(hand.label, 5);
  hand.centroid.y() += 0.08F;
  const float compact = search_skeletons(clusters, small_body(), {})[0].parts[5].error;
  hand.covariance(1, 1) = 0.15F * 0.15F;
  const float elongated = search_skeletons(clusters, small_body(), {})[0].parts[5].error;
  EXPECT_GT(compact, 0.5F);
  EXPECT_LT(elongated, compact - 0.05F);
}

TEST(SearchSkeletons, ExpectsLinksOfTheGivenSize) {
  for (const float size : {0.6F, 1.5F}) {
    std::vector<PartCluster> clusters;
    const Vector3f at(0.F, 0.F, 2.F);
    const std::vector<Vector3f> usual = person_at(at);
    for (int part = 0; part < 6; ++part) {
      if (part == 1) continue;  // head and trunk hang together past the neck
      clusters.push_back(cluster(part, at + size * (usual[part] - at), 0.02F, 0.13F));
    }
    const std::vector<Skeleton> found = search_skeletons(clusters, small_body(), {}, size);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].found, 5);
    EXPECT_NEAR(found[0].total_error, 0.F, 1e-5F);
    for (const Skeleton& other : search_skeletons(clusters, small_body(), {})) {
      EXPECT_TRUE(other.found < 5 || other.total_error > 1.F) << size;
    }
  }
}

TEST(SearchSkeletons, FindsNobodyWithoutProposals) { EXPECT_TRUE(search_skeletons({}, paper_body(), {}).empty()); }

}  // namespace
}  // namespace vesalius
