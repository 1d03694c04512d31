#include "vesalius/group_votes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "capsule/capsule_person.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/test_votes.h"

namespace vesalius {
namespace {

const Camera kCamera{321, 242, 262.5F, 262.5F, 159.5F, 119.5F};  // the last cells of votes are cut
constexpr int kParts = 25;

/// Returns people at these places (x and z in metres), each turned a little more.
LabelledFrame people_at(const std::vector<std::pair<float, float>>& places) {
  CapsuleScene scene;
  scene.floor_y_m = 0.9F;
  scene.wall_z_m = 6.F;
  for (const auto& [x, z] : places) {
    CapsulePerson& person = scene.people.emplace_back();
    person.feet = {x, scene.floor_y_m, z};
    person.pose.yaw = 0.4F * float(scene.people.size());
    person.pose.l_arm.raise = 0.3F;
  }
  return render(scene, kCamera, paper_body());
}

/// Posteriors, their frame, and the groups of their votes.
struct Grouped {
  explicit Grouped(const LabelledFrame& truth, float noise_m = 0.F) : frame(truth.frame) {
    posteriors = test::VotingLabeller(truth, noise_m).label(frame);
    regroup();
  }
  void regroup() { groups = group_votes(posteriors, frame, kParts); }

  Frame frame;
  Posteriors posteriors;
  VoteGroups groups;
};

/// Returns the index of the person whose middle is nearest to a group's.
std::size_t whose(const VoteGroup& group, const LabelledFrame& truth) {
  std::size_t nearest = 0;
  for (std::size_t who = 1; who < truth.parts.size(); ++who) {
    const auto off = [&](std::size_t of) { return (test::true_middle(truth, of) - group.middle).norm(); };
    if (off(who) < off(nearest)) nearest = who;
  }
  return nearest;
}

/// Returns the share of the true people's pixels that have the group of their own person.
double share_right(const Grouped& of, const LabelledFrame& truth) {
  long right = 0, all = 0;
  for (std::size_t i = 0; i < truth.person.size(); ++i) {
    const std::uint8_t group = of.groups.index[i];
    if (truth.person[i] == kBackground) {
      EXPECT_EQ(group, kBackground) << "no pixel of the background belongs to a group";
      continue;
    }
    ++all;
    right += group != kBackground && whose(of.groups.items[group], truth) == truth.person[i] ? 1 : 0;
  }
  return double(right) / double(all);
}

TEST(GroupVotes, ExactVotesGiveEveryPersonAndAllPixels) {
  const LabelledFrame truth = people_at({{-0.9F, 2.2F}, {0.1F, 3.F}, {1.2F, 4.5F}});
  const Grouped of(truth);
  ASSERT_EQ(of.groups.items.size(), 3U);
  std::set<std::size_t> found;
  for (const VoteGroup& group : of.groups.items) {
    const std::size_t who = whose(group, truth);
    found.insert(who);
    EXPECT_LT((group.middle - test::true_middle(truth, who)).norm(), 0.002F);
    EXPECT_LT(group.spread_m, 0.002F);
    EXPECT_NEAR(group.heading.yaw_rad, *body_yaw(truth.parts[who], paper_body()), 1e-3F);
    EXPECT_NEAR(group.heading.confidence, 1.F, 1e-3F);
    EXPECT_FLOAT_EQ(group.body, 1.F);
  }
  EXPECT_EQ(found.size(), 3U);
  EXPECT_GT(share_right(of, truth), 0.999);
  for (std::size_t i = 0; i < of.groups.items.size(); ++i) {
    Mask own(kCamera.width, kCamera.height, 0);
    std::ranges::transform(of.groups.index, own.begin(), [&](int group) { return std::uint8_t{group == int(i)}; });
    const Box box = bounding_box(own), given = of.groups.items[i].box;
    EXPECT_TRUE(given.u == box.u && given.v == box.v && given.width == box.width && given.height == box.height) << i;
  }
}

TEST(GroupVotes, PeopleAThirdOfAMetreApartAreTwo) {
  const LabelledFrame truth = people_at({{-0.2F, 2.5F}, {0.2F, 2.5F}});
  for (const float noise_m : {0.F, 0.06F}) {
    const Grouped of(truth, noise_m);
    ASSERT_EQ(of.groups.items.size(), 2U) << noise_m;
    EXPECT_GT(share_right(of, truth), noise_m == 0.F ? 0.999 : 0.97);
  }
}

TEST(GroupVotes, SomebodyFarBehindSomebodyNearIsFound) {
  const LabelledFrame truth = people_at({{-0.3F, 1.2F}, {1.6F, 5.5F}});
  const Grouped of(truth, 0.08F);
  ASSERT_EQ(of.groups.items.size(), 2U);
  EXPECT_NEAR(of.groups.items[0].spread_m, 0.08F * std::sqrt(3.F), 0.02F);
  EXPECT_GT(share_right(of, truth), 0.99);
}

TEST(GroupVotes, PixelsThatAreRatherBackgroundDoNotVote) {
  const LabelledFrame truth = people_at({{0.F, 2.5F}});
  Grouped of(truth);
  for (int v = 0; v < of.posteriors.height; ++v) {
    for (int u = 0; u < of.posteriors.width; ++u) {
      if (of.frame.depth(u, v) != 0) of.posteriors.at(u, v)[kParts] = 255;
    }
  }
  of.regroup();
  EXPECT_TRUE(of.groups.items.empty()) << "half is not enough";
  EXPECT_TRUE(of.groups.index.empty());
  EXPECT_EQ(main_group(of.groups, Mask(kCamera.width, kCamera.height, 1)), -1);
}

TEST(GroupVotes, WithoutVotesThereAreNoGroups) {
  Grouped of(people_at({{0.F, 2.5F}}));
  of.posteriors.votes = {};
  of.regroup();
  EXPECT_TRUE(of.groups.items.empty());
}

TEST(GroupVotes, FewVotesFarFromAllPeaksBelongToNobody) {
  const LabelledFrame truth = people_at({{0.F, 2.5F}});
  Grouped of(truth);
  const int column = int(kCamera.cx) / kVoteStep, row = int(kCamera.cy) / kVoteStep;
  ASSERT_EQ(truth.person(column * kVoteStep, row * kVoteStep), 0);
  of.posteriors.votes(column, row).middle_mm[1] = -2000;
  of.regroup();
  ASSERT_EQ(of.groups.items.size(), 1U);
  EXPECT_EQ(of.groups.index(column * kVoteStep, row * kVoteStep), kBackground);
}

TEST(GroupVotes, OpposedHeadingsAreUnsure) {
  Grouped of(people_at({{0.F, 2.5F}}));
  for (int row = 0; row < of.posteriors.votes.height(); row += 2) {
    for (int column = 0; column < of.posteriors.votes.width(); ++column) {
      for (std::int16_t& of_axis : of.posteriors.votes(column, row).heading) of_axis = std::int16_t(-of_axis);
    }
  }
  of.regroup();
  ASSERT_EQ(of.groups.items.size(), 1U);
  EXPECT_LT(of.groups.items[0].heading.confidence, 0.2F);
}

TEST(GroupVotes, AreTheSameForAnyNumberOfThreads) {
  const LabelledFrame truth = people_at({{-0.2F, 2.2F}, {0.2F, 2.4F}, {1.2F, 4.5F}});
  const Grouped first(truth, 0.1F);
  for_threads({1, 2, 7}, [&] {
    const Grouped of(truth, 0.1F);
    EXPECT_EQ(of.groups.index, first.groups.index);
    ASSERT_EQ(of.groups.items.size(), first.groups.items.size());
    for (std::size_t i = 0; i < first.groups.items.size(); ++i) {
      EXPECT_EQ(of.groups.items[i].middle, first.groups.items[i].middle);
      EXPECT_EQ(of.groups.items[i].spread_m, first.groups.items[i].spread_m);
      EXPECT_EQ(of.groups.items[i].heading.yaw_rad, first.groups.items[i].heading.yaw_rad);
    }
  });
}

TEST(GroupVotes, MainGroupHasTheMostPixelsOfAMask) {
  const LabelledFrame truth = people_at({{-0.5F, 2.5F}, {0.5F, 2.5F}});
  const Grouped of(truth);
  ASSERT_EQ(of.groups.items.size(), 2U);
  Mask mask(kCamera.width, kCamera.height, 0);
  EXPECT_EQ(main_group(of.groups, mask), -1);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = truth.person[i] == 1 || (truth.person[i] == 0 && i % 3 == 0);
  ASSERT_GE(main_group(of.groups, mask), 0);
  EXPECT_EQ(whose(of.groups.items[main_group(of.groups, mask)], truth), 1U);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = truth.person[i] == kBackground || i % 2 == 0;
  EXPECT_EQ(main_group(of.groups, mask), -1) << "of little of it";
}

}  // namespace
}  // namespace vesalius
