#include "vesalius/base/body_heading.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "capsule/capsule_person.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;

std::vector<Vector3f> centres_of(const CapsulePerson& person) {
  std::vector<Vector3f> centres;
  for (const Eigen::Vector3d& centre : part_centres(make_solids(person))) centres.push_back(centre.cast<float>());
  return centres;
}

CapsulePerson turned(float yaw) {
  CapsulePerson person;
  person.feet = {0.F, 0.9F, 3.F};
  person.pose.yaw = yaw;
  return person;
}

/// Returns the smaller angle between two directions.
float apart(float a, float b) { return std::abs(std::remainder(a - b, 2.F * kPi)); }

TEST(BodyYaw, IsThatOfAPersonStraightAhead) {
  for (const float yaw : {0.F, 0.5F, -0.5F, 1.5F, -1.5F, 2.5F, -2.5F, 3.1F}) {
    const auto found = body_yaw(centres_of(turned(yaw)), paper_body());
    ASSERT_TRUE(found.has_value()) << yaw;
    EXPECT_LT(apart(*found, yaw), 0.12F) << yaw << " came out as " << *found;
  }
}

TEST(BodyYaw, CountsFromTheLineToTheCamera) {
  CapsulePerson person = turned(0.F);
  person.feet.x() = 3.F;  // 45 degrees to the right and looking straight on: the camera sees the person's right side
  const auto found = body_yaw(centres_of(person), paper_body());
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(apart(*found, kPi / 4.F), 0.12F);
}

TEST(BodyYaw, StaysTheSameWhenTheCameraRolls) {
  for (const float yaw : {0.3F, -1.2F, 2.8F}) {
    std::vector<Vector3f> centres = centres_of(turned(yaw));
    const auto upright = body_yaw(centres, paper_body());
    ASSERT_TRUE(upright.has_value());
    for (const float roll : {0.4F, -1.57F, 3.F}) {
      std::vector<Vector3f> rolled;
      for (const Vector3f& c : centres) rolled.emplace_back(Eigen::AngleAxisf(roll, Vector3f::UnitZ()) * c);
      const auto found = body_yaw(rolled, paper_body());
      ASSERT_TRUE(found.has_value());
      EXPECT_LT(apart(*found, *upright), 1e-3F) << yaw << " rolled by " << roll;
    }
  }
}

TEST(BodyYaw, IsUnknownWhereNothingTellsIt) {
  std::vector<Vector3f> centres = centres_of(turned(0.F));
  std::vector<Vector3f> from_above;  // the body's axis points at the camera
  for (const Vector3f& c : centres) from_above.emplace_back(c.x(), c.z() - 3.F, 3.F + c.y());
  EXPECT_FALSE(body_yaw(from_above, paper_body()).has_value());
  std::vector<Vector3f> flat = centres;
  for (Vector3f& c : flat) c.x() = 0.F;  // left and right in one place
  EXPECT_FALSE(body_yaw(flat, paper_body()).has_value());
  const Vector3f unknown = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(body_yaw(std::vector<Vector3f>(25, unknown), paper_body()).has_value());
  EXPECT_FALSE(body_yaw({}, paper_body()).has_value());
}

TEST(BodyYaw, NeedsOnlySomePairs) {
  std::vector<Vector3f> centres = centres_of(turned(1.F));
  const Vector3f unknown = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t p = 0; p < centres.size(); ++p) {
    const std::string& name = paper_body().parts[p].name;
    if (name.find("chest") == std::string::npos && name.find("thigh") == std::string::npos) centres[p] = unknown;
  }
  const auto found = body_yaw(centres, paper_body());
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(apart(*found, 1.F), 0.3F);
}

TEST(BodyUp, PointsFromTheLowerToTheUpperBody) {
  EXPECT_GT(body_up(centres_of(turned(1.F)), paper_body()).dot(-Vector3f::UnitY()), 0.95F);
  std::vector<Vector3f> lying = centres_of(turned(0.F));
  for (Vector3f& c : lying) c = Vector3f(-c.y(), c.x(), c.z());  // the head at the picture's right
  EXPECT_GT(body_up(lying, paper_body()).x(), 0.95F);
}

TEST(BodyUp, IsThePicturesWhereTheBodyDoesNotTell) {
  std::vector<Vector3f> lying = centres_of(turned(0.F));
  for (std::size_t p = 0; p < lying.size(); ++p) {
    lying[p] = Vector3f(-lying[p].y(), lying[p].x(), lying[p].z());
    if (!paper_body().parts[p].upper_body) lying[p].setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  EXPECT_EQ(body_up(lying, paper_body()), -Vector3f::UnitY());
  EXPECT_EQ(body_up(std::vector<Vector3f>(25, Vector3f(0, 0, 2)), paper_body()), -Vector3f::UnitY());
}

TEST(HeadingOfYaw, IsTheNearestOfEvenlySpacedOnes) {
  EXPECT_EQ(heading_of_yaw(0.F, 8), 0);
  EXPECT_EQ(heading_of_yaw(0.39F, 8), 0);
  EXPECT_EQ(heading_of_yaw(0.40F, 8), 1);
  EXPECT_EQ(heading_of_yaw(-0.40F, 8), 7);
  EXPECT_EQ(heading_of_yaw(kPi, 8), 4);
  EXPECT_EQ(heading_of_yaw(-kPi, 8), 4);
  EXPECT_EQ(heading_of_yaw(-kPi / 2.F, 4), 3);
}

}  // namespace
}  // namespace vesalius
