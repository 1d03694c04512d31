#include "vesalius/merge/find_poses.h"

#include <gtest/gtest.h>

#include "vesalius/error.h"
#include "vesalius/merge/test_walkers.h"

namespace vesalius {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

const std::vector<test::Walker> kWalkers = {{{-1.F, 0.F, 2.5F}, {0.3F, 0.F, 0.1F}, 0.F, 0.4F},
                                            {{1.F, 0.F, 3.5F}, {-0.2F, 0.F, -0.1F}, 2.F, -0.3F},
                                            {{0.F, 0.F, 4.F}, {0.1F, 0.F, -0.2F}, 4.F, 0.2F}};

/// Returns what cameras with these poses see of some walkers, 5 times a second; ids count from a number of each.
void watch(PoseFinder& finder, const std::vector<Isometry3f>& first_from, const std::vector<std::vector<int>>& seen,
           double seconds, float noise_m = 0.03F, const std::vector<test::Walker>& walkers = kWalkers) {
  Random random(5);
  for (double time_s = 0.0; time_s < seconds - 1e-9; time_s += 0.2) {
    std::vector<TrackedFrame> frames(first_from.size());
    for (std::size_t c = 0; c < first_from.size(); ++c) {
      for (const int who : seen[c]) {
        const int id = 10 * (int(c) + 1) + (7 * who) % 5;  // nobody has the number of another camera
        frames[c].people.push_back(test::seen_walker(walkers[std::size_t(who)], float(time_s), id,
                                                     first_from[c].inverse(), noise_m, random, float(kJointsBehind_m)));
      }
    }
    finder.add(time_s, frames);
  }
}

void expect_near(const FoundPose& pose, const Isometry3f& truth) {
  EXPECT_LT((pose.first_from_this.translation() - truth.translation()).norm(), 0.03F);
  EXPECT_LT(Eigen::AngleAxisf(pose.first_from_this.linear().transpose() * truth.linear()).angle(), 0.02F);
}

TEST(FindPoses, TellsWhereCamerasStandByThePeople) {
  for (const float degrees : {35.F, 90.F, 150.F, -120.F}) {
    const std::vector<Isometry3f> poses = {Isometry3f::Identity(), test::turned_about(degrees)};
    PoseFinder finder(2);
    watch(finder, poses, {{0, 1, 2}, {2, 0, 1}}, 8.0);
    const auto found = finder.find();
    ASSERT_TRUE(found) << degrees;
    EXPECT_TRUE((*found)[0].first_from_this.isApprox(Isometry3f::Identity()));
    expect_near((*found)[1], poses[1]);
    EXPECT_EQ((*found)[1].moments, 40);
    EXPECT_LT((*found)[1].residual_m, 0.1F);
  }
}

TEST(FindPoses, GoesByWhomBothSee) {
  const std::vector<Isometry3f> poses = {Isometry3f::Identity(), test::turned_about(80.F)};
  PoseFinder finder(2);
  watch(finder, poses, {{0, 1}, {1, 2}}, 8.0);
  const auto found = finder.find();
  ASSERT_TRUE(found);
  expect_near((*found)[1], poses[1]);
}

TEST(FindPoses, TiesACameraThatSeesNobodyOfTheFirst) {
  const std::vector<Isometry3f> poses = {Isometry3f::Identity(), test::turned_about(60.F), test::turned_about(-100.F)};
  PoseFinder finder(3);
  watch(finder, poses, {{0}, {0, 1}, {1}}, 8.0);
  const auto found = finder.find();
  ASSERT_TRUE(found);
  expect_near((*found)[1], poses[1]);
  expect_near((*found)[2], poses[2]);
  EXPECT_EQ((*found)[2].to, 1);
}

TEST(FindPoses, KnowsWhatItDoesNotKnow) {
  const std::vector<Isometry3f> poses = {Isometry3f::Identity(), test::turned_about(90.F)};
  PoseFinder short_one(2), strangers(2), none(2);
  watch(short_one, poses, {{0, 1}, {0, 1}}, 2.0);
  EXPECT_FALSE(short_one.find());
  watch(strangers, poses, {{0}, {2}}, 8.0);
  EXPECT_FALSE(strangers.find());
  watch(none, poses, {{}, {0}}, 8.0);
  EXPECT_FALSE(none.find());
  EXPECT_EQ(none.shared_moments(), 0);
}

TEST(FindPoses, DoesNotChooseAmongPeopleWhoMoveAlike) {
  std::vector<test::Walker> twins(2, kWalkers[0]);
  twins[1].from += Vector3f(1.2F, 0.F, 0.F);
  const std::vector<Isometry3f> poses = {Isometry3f::Identity(), test::turned_about(90.F)};
  PoseFinder finder(2);
  watch(finder, poses, {{0, 1}, {0}}, 8.0, 0.03F, twins);
  EXPECT_FALSE(finder.find());
  PoseFinder both(2);
  watch(both, poses, {{0, 1}, {0, 1}}, 8.0, 0.03F, twins);
  const auto found = both.find();
  ASSERT_TRUE(found);
  expect_near((*found)[1], poses[1]);
}

TEST(FindPoses, EndsAfterTenMinutes) {
  PoseFinder finder(2);
  watch(finder, {Isometry3f::Identity(), test::turned_about(90.F)}, {{}, {}}, 599.0);
  EXPECT_FALSE(finder.is_full());
  watch(finder, {Isometry3f::Identity(), test::turned_about(90.F)}, {{}, {}}, 2.0);
  EXPECT_TRUE(finder.is_full());
  EXPECT_FALSE(finder.find());
}

TEST(FindPoses, RefusesOtherNumbersOfCameras) {
  PoseFinder finder(2);
  EXPECT_THROW(finder.add(0.0, std::vector<TrackedFrame>(3)), Error);
}

}  // namespace
}  // namespace vesalius
