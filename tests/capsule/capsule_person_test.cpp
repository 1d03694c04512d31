#include "capsule/capsule_person.h"

#include <gmock/gmock.h>

#include <limits>
#include <numbers>
#include <set>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using Eigen::Vector3d;

constexpr float kRightAngle = std::numbers::pi_v<float> / 2.F;

Vector3d centre(const CapsulePerson& person, const std::string& part) {
  return part_centres(make_solids(person))[paper_body().find_part(part)];
}

/// Returns the y of the lowest point of all solids. It is the largest y, as y points down.
double lowest_y(const CapsulePerson& person) {
  double lowest = -1e9;
  for (const BodySolid& solid : make_solids(person)) {
    for (const double end : {-solid.shape.half_length, solid.shape.half_length}) {
      const Vector3d c = solid.shape.world({0, end, 0});
      const Vector3d down = solid.shape.world_from_shape.transpose() * Vector3d::UnitY();
      lowest = std::max(lowest, c.y() + down.cwiseProduct(solid.shape.scale_m).norm());
    }
  }
  return lowest;
}

double highest_y(const CapsulePerson& person) {
  double highest = 1e9;
  for (const BodySolid& solid : make_solids(person)) {
    const Vector3d up = solid.shape.world_from_shape.transpose() * Vector3d::UnitY();
    for (const double end : {-solid.shape.half_length, solid.shape.half_length}) {
      highest = std::min(highest, solid.shape.world({0, end, 0}).y() - up.cwiseProduct(solid.shape.scale_m).norm());
    }
  }
  return highest;
}

TEST(CapsulePerson, HasEveryPartOfThePaper) {
  std::set<int> parts;
  for (const BodySolid& solid : make_solids({})) {
    for (const auto& halves : solid.part) parts.insert(halves.begin(), halves.end());
  }
  EXPECT_EQ(parts.size(), 25U);
  EXPECT_EQ(*parts.begin(), 0);
  EXPECT_EQ(*parts.rbegin(), 24);
}

TEST(CapsulePerson, StandsOnTheGroundAsTallAsItsStature) {
  for (const float stature_m : {1.2F, 1.75F, 1.95F}) {
    for (const float girth : {0.8F, 1.F, 1.5F}) {
      CapsulePerson person;
      person.build.stature_m = stature_m;
      person.build.girth = girth;
      EXPECT_NEAR(lowest_y(person), 1.0, 1e-4) << stature_m << " m, girth " << girth;
      EXPECT_NEAR(highest_y(person), 1.0 - stature_m, 0.012 * stature_m);
    }
  }
}

TEST(CapsulePerson, KeepsTheLowerFootOnTheGroundInEveryPose) {
  CapsulePerson walking;
  walking.pose.l_leg = {0.F, 0.6F, 0.2F};
  walking.pose.r_leg = {0.F, -0.3F, 0.5F};
  EXPECT_NEAR(lowest_y(walking), 1.0, 1e-4);
  CapsulePerson sitting;
  sitting.pose.l_leg = sitting.pose.r_leg = {0.1F, kRightAngle, kRightAngle};
  EXPECT_NEAR(lowest_y(sitting), 1.0, 1e-4);
  EXPECT_GT(highest_y(sitting), highest_y({}) + 0.3) << "sitting is lower than standing";
}

TEST(CapsulePerson, PutsTheFeetInTheirPlaceAtAnyYaw) {
  for (const float yaw : {0.F, 1.F, 3.F, -2.F}) {
    CapsulePerson person;
    person.feet = {0.3F, 1.F, 2.F};
    person.pose.yaw = yaw;
    const Vector3d forward(std::sin(yaw), 0.0, -std::cos(yaw));
    const Vector3d middle = 0.5 * (centre(person, "l_foot") + centre(person, "r_foot"));
    EXPECT_NEAR((middle - 0.25 * 0.152 * 1.75 * forward - Vector3d(0.3, middle.y(), 2.0)).norm(), 0.0, 1e-5) << yaw;
  }
}

// The left side of a person who faces the camera is on the picture's right.
TEST(CapsulePerson, NamesSidesFromThePersonsView) {
  CapsulePerson person;
  EXPECT_GT(centre(person, "l_hand").x(), 0.1);
  EXPECT_LT(centre(person, "r_hand").x(), -0.1);
  EXPECT_LT(centre(person, "l_foot").z(), 2.5) << "toes towards the camera";
  person.pose.yaw = 2.F * kRightAngle;
  EXPECT_LT(centre(person, "l_hand").x(), -0.1);
  EXPECT_GT(centre(person, "l_foot").z(), 2.5);
  person.pose.yaw = kRightAngle;  // turned to their own left, which is the picture's right
  EXPECT_GT(centre(person, "l_foot").x(), 0.0);
}

TEST(CapsulePerson, MovesTheLimbThatAnAngleNames) {
  const CapsulePerson rest;
  CapsulePerson person;
  person.pose.l_arm.raise = kRightAngle;
  EXPECT_GT(centre(person, "l_hand").x(), 0.65);
  EXPECT_NEAR(centre(person, "l_hand").y(), centre(person, "l_upper_arm").y(), 1e-3);
  EXPECT_EQ(centre(person, "r_hand"), centre(rest, "r_hand"));

  person = {};
  person.pose.r_arm.forward = kRightAngle;
  EXPECT_LT(centre(person, "r_hand").z(), 2.5 - 0.5);
  person.pose.r_arm.elbow = kRightAngle;  // forearm up
  EXPECT_LT(centre(person, "r_hand").y(), centre(person, "r_elbow").y() - 0.2);

  person = {};
  person.pose.lean = 0.5F;
  EXPECT_LT(centre(person, "neck").z(), 2.5 - 0.2) << "forward is towards the camera";
  person = {};
  person.pose.side_lean = 0.5F;
  EXPECT_GT(centre(person, "neck").x(), 0.2);

  person = {};
  person.pose.head_pitch = 0.5F;
  EXPECT_LT(centre(person, "l_face_top").z(), centre(rest, "l_face_top").z() - 0.03);

  person = {};
  person.pose.l_leg = {0.F, kRightAngle, kRightAngle};
  EXPECT_LT(centre(person, "l_knee").z(), centre(person, "l_hips").z() - 0.35);
  EXPECT_GT(centre(person, "l_foot").y(), centre(person, "l_knee").y() + 0.3);
}

TEST(CapsulePerson, HasItsPartsInOrderAlongTheLimbs) {
  const std::vector<std::string> down = {"face_top", "face_bottom", "chest", "hips", "thigh", "knee", "leg", "foot"};
  const std::vector<std::string> arm = {"upper_arm", "elbow", "forearm", "hand"};
  for (const std::string side : {"l_", "r_"}) {
    for (const auto& chain : {down, arm}) {
      for (std::size_t i = 1; i < chain.size(); ++i) {
        EXPECT_LT(centre({}, side + chain[i - 1]).y(), centre({}, side + chain[i]).y()) << side << chain[i];
      }
    }
  }
}

TEST(CapsulePerson, HasMirroredCentresInAMirroredPose) {
  CapsulePerson person, mirrored;
  person.feet = {0.4F, 1.F, 2.F};
  person.pose.yaw = 0.7F;
  person.pose.side_lean = 0.2F;
  person.pose.head_yaw = -0.4F;
  person.pose.l_arm = {1.F, 0.5F, 0.8F};
  person.pose.r_leg = {0.2F, 0.4F, 0.6F};
  mirrored.feet = {-0.4F, 1.F, 2.F};
  mirrored.pose.yaw = -0.7F;
  mirrored.pose.side_lean = -0.2F;
  mirrored.pose.head_yaw = 0.4F;
  mirrored.pose.r_arm = person.pose.l_arm;
  mirrored.pose.l_leg = person.pose.r_leg;
  for (const BodyPart& part : paper_body().parts) {
    const Vector3d a = centre(person, part.name);
    const Vector3d b = centre(mirrored, paper_body().parts[part.mirror].name);
    EXPECT_NEAR((a - Vector3d(-b.x(), b.y(), b.z())).norm(), 0.0, 1e-12) << part.name;
  }
}

TEST(CapsulePerson, RefusesImpossibleBuilds) {
  CapsulePerson person;
  person.build.stature_m = 0.F;
  EXPECT_THROW(make_solids(person), Error);
  person = {};
  person.build.girth = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(make_solids(person), Error);
  person = {};
  person.pose.l_leg.knee = std::numeric_limits<float>::infinity();
  EXPECT_THROW(make_solids(person), Error);
  person = {};
  person.feet.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(make_solids(person), Error);
}

}  // namespace
}  // namespace vesalius
