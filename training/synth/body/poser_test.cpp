#include "synth/body/poser.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <set>

#include "synth/body/body_mesh.h"
#include "synth/body/makehuman.h"
#include "synth/body/test_bodies.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

Eigen::Vector3f in_mirror(const Eigen::Vector3f& p) { return {-p.x(), p.y(), p.z()}; }

/// Returns the name of the same thing on the other side, for names such as "wrist.L" and "l_hand".
std::string name_in_mirror(std::string name) {
  const auto swap = [](char& c, char l, char r) { c = c == l ? r : c == r ? l : c; };
  if (name.starts_with("l_") || name.starts_with("r_")) swap(name.front(), 'l', 'r');
  if (name.ends_with(".L") || name.ends_with(".R")) swap(name.back(), 'L', 'R');
  return name;
}

RigBone in_mirror(const RigBone& bone) {
  RigBone out = bone;
  out.name = name_in_mirror(bone.name);
  out.head = in_mirror(bone.head);
  out.tail = in_mirror(bone.tail);
  out.from = mirror(bone.from);
  out.to = mirror(bone.to);
  const Eigen::Quaternionf& q = bone.t_from_rest;
  out.t_from_rest = Eigen::Quaternionf(q.w(), q.x(), -q.y(), -q.z());
  out.grip = bone.grip == Grip::left ? Grip::right : bone.grip == Grip::right ? Grip::left : Grip::none;
  out.curl_axis = -in_mirror(bone.curl_axis);  // an axis is a pseudo-vector
  return out;
}

/// Returns the mirror image (x -> -x) of the mesh and its labels.
BodyMesh mirrored(const BodyMesh& mesh, const BodyModel& body) {
  BodyMesh out = mesh;
  auto topology = std::make_shared<BodyTopology>(*mesh.topology);
  for (Triangle& t : topology->triangles) std::swap(t[0], t[2]);  // keeps the orientation
  for (std::uint8_t& part : topology->part) {
    if (part != kBackground) part = static_cast<std::uint8_t>(body.parts[part].mirror);
  }
  out.topology = std::move(topology);
  for (Eigen::Vector3f& p : out.vertices) p = in_mirror(p);
  for (RigBone& bone : out.rig) bone = in_mirror(bone);
  for (int b = 0; b < kBoneCount; ++b) {
    out.rig_of[index(mirror(static_cast<Bone>(b)))] = mesh.rig_of[b];
  }
  return out;
}

std::shared_ptr<const BodyMesh> person() {
  static const auto mesh = std::make_shared<const BodyMesh>(make_body(builtin_bodies(), {}, paper_body()));
  return mesh;
}

std::size_t at(Bone bone) { return static_cast<std::size_t>(bone); }
std::size_t part(const char* name) { return static_cast<std::size_t>(paper_body().find_part(name)); }

TEST(Poser, TurnsTheIdentityIntoTheT) {
  const PosedBody body = Poser(person(), paper_body()).pose({});
  const auto along = [&](Bone bone) {
    return (body.ends[at(bone)] - body.joints[at(bone)]).normalized().dot(rest_direction(bone));
  };
  for (const Bone bone : {Bone::l_upper_arm, Bone::l_forearm, Bone::r_upper_arm, Bone::r_forearm, Bone::l_thigh,
                          Bone::l_shin, Bone::r_thigh, Bone::r_shin}) {
    EXPECT_GT(along(bone), 0.9999F) << bone_name(bone);
  }
  // Hands at rest are a little bent.
  for (const Bone hand : {Bone::l_hand, Bone::r_hand}) EXPECT_GT(along(hand), 0.94F) << bone_name(hand);
  EXPECT_GT(body.parts[part("l_hand")].x(), 0.5F);  // the person's left is +x
  EXPECT_LT(body.parts[part("r_hand")].x(), -0.5F);
  EXPECT_GT(body.ends[at(Bone::l_foot)].z(), body.joints[at(Bone::l_foot)].z() + 0.1F);
  EXPECT_GT(body.parts[part("l_face_top")].y(), body.parts[part("l_face_bottom")].y());
}

TEST(Poser, PutsTheBodyOnTheFloorUnderThePelvis) {
  const Poser poser(person(), paper_body());
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const PosedBody body = poser.pose(random_pose(random, 1.F));
    const auto lowest = std::ranges::min(body.vertices, {}, [](const Vector3f& p) { return p.y(); }).y();
    EXPECT_NEAR(lowest, 0.F, 1e-5F);
    EXPECT_NEAR(body.joints[0].x(), 0.F, 1e-5F);
    EXPECT_NEAR(body.joints[0].z(), 0.F, 1e-5F);
  }
}

TEST(Poser, KeepsTheLengthsOfBones) {
  const Poser poser(person(), paper_body());
  const auto rest = rest_bones(*person());
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const PosedBody body = poser.pose(random_pose(random, 2.F));
    for (std::size_t b = 0; b < kBoneCount; ++b) {
      // Between the ends of these the rig bends.
      const Bone bone = static_cast<Bone>(b);
      if (bone == Bone::spine || bone == Bone::chest || bone == Bone::neck) continue;
      if (bone == Bone::l_clavicle || bone == Bone::r_clavicle) continue;
      EXPECT_NEAR((body.ends[b] - body.joints[b]).norm(), (rest[b].tail - rest[b].head).norm(), 1e-4F) << b;
    }
  }
}

TEST(Poser, TurnsTheWholeBodyByThePelvisHeading) {
  const Poser poser(person(), paper_body());
  Random random(3);
  Pose pose = random_pose(random, 0.8F);
  const PosedBody before = poser.pose(pose);
  const Eigen::Quaternionf turn(Eigen::AngleAxisf(1.F, Vector3f::UnitY()));
  pose[Bone::pelvis] = turn * pose[Bone::pelvis];
  const PosedBody after = poser.pose(pose);
  for (std::size_t v = 0; v < after.vertices.size(); v += 97) {
    EXPECT_LT((after.vertices[v] - turn * before.vertices[v]).norm(), 1e-4F);
  }
  for (std::size_t p = 0; p < after.parts.size(); ++p) {
    EXPECT_LT((after.parts[p] - turn * before.parts[p]).norm(), 1e-4F);
  }
}

TEST(Poser, MovesOnlyFingersForAFist) {
  const Poser poser(person(), paper_body());
  Pose open;
  open.l_grip = open.r_grip = 0.F;
  Pose fist = open;
  fist.l_grip = 1.F;
  const PosedBody a = poser.pose(open);
  const PosedBody b = poser.pose(fist);
  const std::uint8_t hand = static_cast<std::uint8_t>(part("l_hand"));
  float farthest = 0.F;
  std::vector<bool> of_hand(a.vertices.size(), false);
  const BodyTopology& topology = *person()->topology;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    for (const std::uint32_t v : topology.triangles[t]) of_hand[v] = of_hand[v] || topology.part[t] == hand;
  }
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    const float moved = (a.vertices[v] - b.vertices[v]).norm();
    if (of_hand[v]) farthest = std::max(farthest, moved);
    EXPECT_TRUE(of_hand[v] || moved < 0.01F) << moved;
  }
  EXPECT_GT(farthest, 0.06F);
  // In the T hands point outwards, and fingers close towards the palm.
  EXPECT_LT(b.parts[hand].x(), a.parts[hand].x() - 0.002F);
}

TEST(Poser, PosesMirrorImagesAsMirrorImages) {
  const auto twin = std::make_shared<const BodyMesh>(mirrored(*person(), paper_body()));
  const Poser poser(person(), paper_body());
  const Poser other(twin, paper_body());
  Random random(4);
  for (int i = 0; i < 10; ++i) {
    const Pose pose = random_pose(random, 1.F);
    const PosedBody a = poser.pose(pose);
    const PosedBody b = other.pose(mirrored(pose));
    const auto in_mirror = [](const Vector3f& p) { return Vector3f(-p.x(), p.y(), p.z()); };
    for (std::size_t v = 0; v < a.vertices.size(); v += 31) {
      EXPECT_LT((in_mirror(a.vertices[v]) - b.vertices[v]).norm(), 1e-4F);
    }
    for (std::size_t p = 0; p < a.parts.size(); ++p) {
      const auto partner = static_cast<std::size_t>(paper_body().parts[p].mirror);
      EXPECT_LT((in_mirror(a.parts[p]) - b.parts[partner]).norm(), 1e-4F);
    }
  }
}

TEST(Poser, GivesTheCentresOfThePartsVolumes) {
  const auto mesh = std::make_shared<const BodyMesh>(box_body(3, 5));
  const PosedBody body = Poser(mesh, paper_body()).pose({});
  EXPECT_LT((body.parts[3] - Vector3f(0.5F, 1.F, 0.F)).norm(), 1e-5F);  // each half counts as a closed box
  EXPECT_LT((body.parts[5] - Vector3f(-0.5F, 1.F, 0.F)).norm(), 1e-5F);
  EXPECT_TRUE(body.parts[0].hasNaN());  // the box has no left foot
}

TEST(Poser, HasSharesThatSumToOneForEachPart) {
  std::vector<float> sums(25, 0.F);
  for (const PartShare& s : part_shares(*person(), 25)) sums[s.part] += s.share;
  for (const float sum : sums) EXPECT_NEAR(sum, 1.F, 1e-4F);
}

TEST(Poser, RefusesAPoseThatIsNotFinite) {
  const Poser poser(person(), paper_body());
  Pose pose;
  pose[Bone::neck].w() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(poser.pose(pose), Error);
  pose = {};
  pose.l_grip = std::numeric_limits<float>::infinity();
  EXPECT_THROW(poser.pose(pose), Error);
}

TEST(BodyMesh, IsTheSameWhenMirroredTwice) {
  const BodyMesh twice = mirrored(mirrored(*person(), paper_body()), paper_body());
  EXPECT_EQ(twice.topology->part, person()->topology->part);
  EXPECT_EQ(twice.topology->triangles, person()->topology->triangles);
  EXPECT_EQ(twice.vertices, person()->vertices);
  EXPECT_EQ(twice.rig_of, person()->rig_of);
}

struct BadMesh {
  const char* what;
  std::function<void(BodyMesh&, BodyTopology&)> spoil;
  const char* message;
};

class BodyMeshCheck : public testing::TestWithParam<BadMesh> {};

TEST_P(BodyMeshCheck, NamesWhatIsWrong) {
  BodyMesh mesh = box_body(3, 5);
  auto topology = std::make_shared<BodyTopology>(*mesh.topology);
  mesh.topology = topology;
  EXPECT_NO_THROW(check(mesh, paper_body()));
  GetParam().spoil(mesh, *topology);
  EXPECT_THAT([&] { check(mesh, paper_body()); }, ThrowsMessage<Error>(HasSubstr(GetParam().message)));
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    All, BodyMeshCheck,
    testing::Values(
        BadMesh{"index", [](BodyMesh&, BodyTopology& top) { top.triangles[2][1] = 12; }, "triangle 2 uses vertex 12"},
        BadMesh{"part", [](BodyMesh&, BodyTopology& top) { top.part[1] = 25; }, "part 25, expected one below 25"},
        BadMesh{"parts", [](BodyMesh&, BodyTopology& top) { top.part.pop_back(); }, "expected one for each"},
        BadMesh{"skin", [](BodyMesh&, BodyTopology& top) { top.skin.pop_back(); }, "skin weights, expected one"},
        BadMesh{"sum", [](BodyMesh&, BodyTopology& top) { top.skin[4].weight[0] = 0.5F; },
                "vertex 4: its skin weights sum"},
        BadMesh{"weight", [](BodyMesh&, BodyTopology& top) { top.skin[4].weight[1] = kNaN; },
                "vertex 4: expected weights"},
        BadMesh{"bone", [](BodyMesh&, BodyTopology& top) { top.skin[0].bone[0] = 1; }, "hangs on bone 1"},
        BadMesh{"vertex", [](BodyMesh& m, BodyTopology&) { m.vertices[7].y() = kNaN; }, "vertex 7 is not finite"},
        BadMesh{"rig", [](BodyMesh& m, BodyTopology&) { m.rig_of[3] = 1; }, "head of rig bone 1"},
        BadMesh{"parent", [](BodyMesh& m, BodyTopology&) { m.rig[0].parent = 0; }, "its parent before it"},
        BadMesh{"turn", [](BodyMesh& m, BodyTopology&) { m.rig[0].t_from_rest.w() = 2.F; }, "unit quaternion"},
        BadMesh{"nobody", [](BodyMesh&, BodyTopology& top) { std::ranges::fill(top.part, kBackground); },
                "expected a person"},
        BadMesh{"stature", [](BodyMesh& m, BodyTopology&) { m.stature_m = 0.F; }, "stature"},
        BadMesh{"empty", [](BodyMesh& m, BodyTopology&) { m.topology = nullptr; }, "no topology"}),
    [](const auto& test) { return test.param.what; });

using Eigen::Isometry3f;
using Eigen::Vector3f;

const BodyMesh& mesh() {
  static const BodyMesh body = make_body(builtin_bodies(), {}, paper_body());
  return body;
}

PosedBody posed(const Pose& pose) { return Poser(std::make_shared<const BodyMesh>(mesh()), paper_body()).pose(pose); }

std::size_t joint(const std::string& name) {
  const auto& names = joint_names();
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

TEST(SkeletonJoints, HaveTheNamesOfBonesAndFreeEnds) {
  const auto& names = joint_names();
  ASSERT_EQ(names.size(), 24U);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (std::size_t b = 0; b < kBoneCount; ++b) EXPECT_EQ(names[b], bone_name(static_cast<Bone>(b)));
  const PosedBody body = posed({});
  const std::vector<Vector3f> points = joint_points(body, Isometry3f::Identity());
  ASSERT_EQ(points.size(), names.size());
  EXPECT_EQ(points[joint("l_shin")], body.joints[index(Bone::l_shin)]);
  EXPECT_EQ(points[joint("r_hand_end")], body.ends[index(Bone::r_hand)]);
  EXPECT_GT(points[joint("head_end")].y(), points[joint("head")].y() + 0.1F);
}

TEST(SkeletonJoints, AreInTheCamerasFrame) {
  const PosedBody body = posed({});
  const Isometry3f motion = Eigen::Translation3f(0.5F, -1.F, 3.F) * Eigen::AngleAxisf(0.7F, Vector3f::UnitY());
  const std::vector<Vector3f> own = joint_points(body, Isometry3f::Identity());
  const std::vector<Vector3f> seen = joint_points(body, motion);
  for (std::size_t j = 0; j < own.size(); ++j) EXPECT_LT((seen[j] - motion * own[j]).norm(), 1e-6F) << joint_names()[j];
}

TEST(SkeletonJoints, LieInsideTheBody) {
  Random random(3);
  for (const float most_rad : {0.F, 0.4F, 0.4F}) {
    const PosedBody body = posed(random_pose(random, most_rad));
    const auto& triangles = mesh().topology->triangles;
    const std::vector<Vector3f> points = joint_points(body, Isometry3f::Identity());
    for (std::size_t j = 0; j < points.size(); ++j) {
      // Free ends lie on the surface, or off it by the rounding of fingers and toes. Those of closed hands lie where
      // the open hand would end.
      const bool inside = is_inside(body.vertices, triangles, mesh().topology->body_triangles, points[j]);
      const float off =
          inside ? 0.F : distance_to(body.vertices, triangles, mesh().topology->body_triangles, points[j]);
      EXPECT_LT(off, joint_names()[j].ends_with("hand_end") ? 0.07F : 0.02F)
          << joint_names()[j] << " at turns of " << most_rad;
    }
  }
}

TEST(SkeletonJoints, SwapSidesInAMirror) {
  Random random(4);
  const Pose pose = random_pose(random, 0.6F);
  const std::vector<Vector3f> own = joint_points(posed(pose), Isometry3f::Identity());
  const std::vector<Vector3f> other = joint_points(posed(mirrored(pose)), Isometry3f::Identity());
  for (std::size_t j = 0; j < own.size(); ++j) {
    std::string name = joint_names()[j];
    if (name.starts_with("l_") || name.starts_with("r_")) name[0] = name[0] == 'l' ? 'r' : 'l';
    const Vector3f expected(-own[j].x(), own[j].y(), own[j].z());
    EXPECT_LT((other[joint(name)] - expected).norm(), 1e-3F) << name;
  }
}

}  // namespace

}  // namespace vesalius::synth
