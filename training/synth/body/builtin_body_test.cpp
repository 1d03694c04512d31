#include "synth/body/builtin_body.h"

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "synth/body/poser.h"
#include "synth/body/test_bodies.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

MakeHumanFactors person(float gender, float age_years, float weight, float stature_m) {
  MakeHumanFactors factors;
  factors.gender = gender;
  factors.age_years = age_years;
  factors.weight = weight;
  factors.stature_m = stature_m;
  return factors;
}

std::vector<MakeHumanFactors> people() {
  std::vector<MakeHumanFactors> all{person(1.F, 30.F, 0.5F, 1.8F),  person(0.F, 30.F, 0.5F, 1.62F),
                                    person(0.5F, 5.F, 0.5F, 1.05F), person(1.F, 50.F, 1.F, 1.75F),
                                    person(0.F, 20.F, 0.F, 1.6F),   person(0.F, 70.F, 1.F, 1.6F)};
  for (std::uint64_t i = 0; i < 14; ++i) {
    Random random(11, i);
    all.push_back(sample_factors({}, random));
  }
  return all;
}

TEST(BuiltinBody, HasTheGivenStatureAndStandsOnTheFloor) {
  for (const MakeHumanFactors& factors : people()) {
    const BodyMesh mesh = make_builtin_body(factors, paper_body());
    const auto [low, high] = std::ranges::minmax(mesh.vertices, {}, [](const Vector3f& p) { return p.y(); });
    EXPECT_NEAR(low.y(), 0.F, 1e-5F);
    EXPECT_NEAR(high.y(), factors.stature_m, 0.001F);
    EXPECT_FLOAT_EQ(mesh.stature_m, factors.stature_m);
    EXPECT_TRUE(is_closed(mesh.topology->triangles, mesh.topology->triangles.size()));
    EXPECT_GT(mesh.topology->triangles.size(), 3000U);
    EXPECT_LT(mesh.topology->triangles.size(), 6000U);
    EXPECT_EQ(std::set<int>(mesh.topology->part.begin(), mesh.topology->part.end()).size(), 25U);
  }
}

TEST(BuiltinBody, HasExactlyMirroredSides) {
  for (const MakeHumanFactors& factors : people()) {
    const BodyMesh mesh = make_builtin_body(factors, paper_body());
    const BodyTopology& topology = *mesh.topology;
    std::map<std::array<float, 3>, std::uint32_t> by_place;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vector3f& p = mesh.vertices[v];
      EXPECT_TRUE(by_place.insert({{p.x(), p.y(), p.z()}, v}).second || p.x() == 0.F);
    }
    const std::size_t half = topology.triangles.size() / 2;
    for (std::size_t t = 0; t < half; ++t) {
      const int partner = paper_body().parts[topology.part[t]].mirror;
      ASSERT_EQ(partner, static_cast<int>(topology.part[t + half])) << t;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3f& p = mesh.vertices[topology.triangles[t][k]];
        const Vector3f& q = mesh.vertices[topology.triangles[t + half][2 - k]];
        ASSERT_EQ(p, Vector3f(-q.x(), q.y(), q.z()));
      }
    }
  }
}

// Labels: statistics
TEST(BuiltinBody, HasItsJointsInsideInAnyModeratePose) {
  int outside = 0;
  int all = 0;
  for (const MakeHumanFactors& factors : people()) {
    const auto mesh = std::make_shared<const BodyMesh>(make_builtin_body(factors, paper_body()));
    const Poser poser(mesh, paper_body());
    Random random(5);
    for (int i = 0; i < 3; ++i) {
      const PosedBody body = poser.pose(random_pose(random, 0.6F));
      for (const Vector3f& joint : body.joints) {
        ++all;
        if (!is_inside(body.vertices, mesh->topology->triangles, mesh->topology->triangles.size(), joint)) ++outside;
      }
    }
  }
  EXPECT_EQ(outside, 0) << "of " << all;
}

TEST(BuiltinBody, HasTheCentresOfPartsInside) {
  int outside = 0;
  for (const MakeHumanFactors& factors : people()) {
    const auto mesh = std::make_shared<const BodyMesh>(make_builtin_body(factors, paper_body()));
    const PosedBody body = Poser(mesh, paper_body()).pose({});
    for (const Vector3f& centre : body.parts) {
      ASSERT_TRUE(centre.allFinite());
      if (!is_inside(body.vertices, mesh->topology->triangles, mesh->topology->triangles.size(), centre)) ++outside;
    }
  }
  EXPECT_EQ(outside, 0);
}

TEST(BuiltinBody, FacesForwardsWithItsFeet) {
  const BodyMesh mesh = make_builtin_body({}, paper_body());
  const Vector3f& front =
      std::ranges::max(mesh.vertices, {}, [](const Vector3f& p) { return p.y() > 1.4F ? p.z() : -9.F; });
  const Vector3f& back =
      std::ranges::min(mesh.vertices, {}, [](const Vector3f& p) { return p.y() > 1.4F ? p.z() : 9.F; });
  EXPECT_EQ(front.x(), 0.F);                // the nose, on the middle line
  EXPECT_GT(front.z(), -back.z() + 0.01F);  // extends further than the back of the head
  const Vector3f& toe =
      std::ranges::max(mesh.vertices, {}, [](const Vector3f& p) { return p.y() < 0.1F ? p.z() : -9.F; });
  EXPECT_GT(toe.z(), 0.12F);
}

TEST(BuiltinBody, FollowsItsFactors) {
  const auto depth_of_trunk = [](const BodyMesh& mesh) {
    float front = 0.F, back = 0.F;
    for (const Vector3f& p : mesh.vertices) {
      if (std::abs(p.y() - 0.6F * mesh.stature_m) > 0.03F * mesh.stature_m) continue;
      if (std::abs(p.x()) > 0.1F * mesh.stature_m) continue;
      front = std::max(front, p.z());
      back = std::min(back, p.z());
    }
    return front - back;
  };
  const BodyMesh thin = make_builtin_body(person(0.5F, 30.F, 0.F, 1.7F), paper_body());
  const BodyMesh heavy = make_builtin_body(person(0.5F, 30.F, 1.F, 1.7F), paper_body());
  EXPECT_GT(depth_of_trunk(heavy), 1.2F * depth_of_trunk(thin));
  const auto head_share = [](const BodyMesh& mesh) {
    const auto bones = rest_bones(mesh);
    return (mesh.stature_m - bones[index(Bone::neck)].head.y()) / mesh.stature_m;
  };
  const BodyMesh child = make_builtin_body(person(0.5F, 5.F, 0.5F, 1.F), paper_body());
  EXPECT_GT(head_share(child), 1.08F * head_share(thin));
}

TEST(BuiltinBody, IsTheSameForTheSameFactors) {
  const BodyMesh a = make_builtin_body({}, paper_body());
  const BodyMesh b = make_builtin_body({}, paper_body());
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.topology->triangles, b.topology->triangles);
}

TEST(BuiltinBody, SamplesPeopleOfHumanHeight) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Random random(1, i);
    const MakeHumanFactors factors = sample_factors({}, random);
    EXPECT_GT(factors.stature_m, factors.age_years < 18.F ? 0.9F : 1.38F);
    EXPECT_LT(factors.stature_m, factors.gender > 0.5F ? 1.95F : 1.86F);
  }
}

}  // namespace
}  // namespace vesalius::synth
