#include "vesalius/merge/carry_people.h"

#include <gtest/gtest.h>

#include "vesalius/merge/test_walkers.h"
#include "vesalius/track/track_floor.h"

namespace vesalius {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

FittedBody two_bones() {
  FittedBody body;
  body.bones.resize(2);
  body.bones[0].head = {0.F, 0.F, 2.F};
  body.bones[0].tail = body.bones[1].head = {0.F, -0.5F, 2.F};
  body.bones[1].tail = {0.3F, -0.5F, 2.F};
  body.bones[1].local = Eigen::AngleAxisf(0.4F, Vector3f::UnitZ());
  body.bones[1].global = body.bones[1].local;
  body.bones[0].covariance = Vector3f(1e-4F, 4e-4F, 9e-4F).asDiagonal();
  return body;
}

TEST(CarryPeople, KeepsLengthsAndComesBack) {
  Random random(1);
  const Isometry3f there = test::turned_about(70.F) * Eigen::Translation3f(0.2F, 0.1F, -0.4F);
  TrackedPerson person =
      test::seen_walker({{0.F, 0.F, 3.F}, {1.F, 0.F, 0.F}}, 0.F, 1, Isometry3f::Identity(), 0.F, random);
  person.body = two_bones();
  person.person.skeleton.voted = {{Vector3f(0.1F, -0.2F, 3.F), 0.05F}};
  TrackedPerson carried = person;
  carry(carried, there, 0.F);
  EXPECT_LT((carried.person.skeleton.voted[0].centre - there * Vector3f(0.1F, -0.2F, 3.F)).norm(), 1e-6F);
  EXPECT_LT((carried.position - there * person.position).norm(), 1e-6F);
  EXPECT_NEAR(carried.velocity.norm(), 1.F, 1e-6F);
  const FittedBone& root = carried.body->bones[0];
  EXPECT_NEAR((root.tail - root.head).norm(), 0.5F, 1e-6F);
  EXPECT_TRUE(root.local.isApprox(root.global, 1e-6F));
  // The second is turned from its parent as before.
  EXPECT_TRUE(
      (carried.body->bones[0].global * carried.body->bones[1].local).isApprox(carried.body->bones[1].global, 1e-5F));
  EXPECT_NEAR(root.covariance.trace(), 14e-4F, 1e-7F);
  carry(carried, there.inverse(), 0.F);
  for (std::size_t j = 0; j < 15; ++j) {
    EXPECT_LT((carried.person.joints[0][j].position - person.person.joints[0][j].position).norm(), 1e-5F);
  }
}

TEST(CarryPeople, GoesAheadAsThePersonMoves) {
  Random random(1);
  TrackedPerson person =
      test::seen_walker({{0.F, 0.F, 3.F}, {1.F, 0.F, 0.F}}, 0.F, 1, Isometry3f::Identity(), 0.F, random);
  const Vector3f hand = person.person.joints[0][4].position;
  carry(person, test::turned_about(90.F), 0.1F);
  const Vector3f expected = test::turned_about(90.F) * Vector3f(hand + Vector3f(0.1F, 0.F, 0.F));
  EXPECT_LT((person.person.joints[0][4].position - expected).norm(), 1e-5F);
}

TEST(CarryPeople, TakesTheFloorAlong) {
  // A level camera 1.2 m over the floor, seen from one 0.5 m lower that looks 20 degrees down.
  const FloorView level{{0.F, -1.F, 0.F}, 1.2F, 0.F, 0.F};
  Isometry3f lower_from_level = Isometry3f::Identity();
  lower_from_level.linear() = Eigen::AngleAxisf(0.349066F, Vector3f::UnitX()).toRotationMatrix();
  lower_from_level.translation() = lower_from_level.linear() * Vector3f(0.3F, -0.5F, 0.F);
  const FloorView lower = carried(level, lower_from_level);
  EXPECT_NEAR(lower.height_m, 0.7F, 1e-5F);
  EXPECT_NEAR(std::abs(lower.tilt_rad), 0.349066F, 1e-5F);
  EXPECT_NEAR(lower.roll_rad, 0.F, 1e-5F);
  // A point of the floor stays on it.
  const Vector3f point = lower_from_level * Vector3f(0.7F, 1.2F, 2.F);
  EXPECT_NEAR((floor_from_optical(lower) * point).y(), 0.F, 1e-5F);
}

}  // namespace
}  // namespace vesalius
