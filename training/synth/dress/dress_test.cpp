#include "synth/dress/dress.h"

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "synth/body/body_mesh.h"
#include "synth/body/makehuman.h"
#include "synth/body/poser.h"
#include "synth/body/test_bodies.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

const BodyMesh& bare() {
  static const BodyMesh mesh = make_body(builtin_bodies(), {}, paper_body());
  return mesh;
}

BodyMesh dressed(const Outfit& outfit, std::uint64_t seed = 1) {
  Random random(seed);
  return dress(bare(), outfit, paper_body(), random);
}

/// Returns the parts of the triangles that were added to the body's own.
std::set<int> added_parts(const BodyMesh& mesh) {
  return {mesh.topology->part.begin() + static_cast<std::ptrdiff_t>(mesh.topology->body_triangles),
          mesh.topology->part.end()};
}

int part(const char* name) { return paper_body().find_part(name); }

TEST(Dress, MovesTheSkinByTheThicknessOfClothesAndKeepsItsLabels) {
  Outfit outfit;
  outfit.top_m = outfit.bottom_m = 0.015F;
  outfit.hair_m = 0.04F;
  outfit.folds = 0.F;
  const BodyMesh mesh = dressed(outfit);
  EXPECT_EQ(mesh.topology->part, bare().topology->part);
  EXPECT_EQ(mesh.topology->triangles, bare().topology->triangles);
  float most = 0.F;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    most = std::max(most, (mesh.vertices[v] - bare().vertices[v]).norm());
  }
  EXPECT_NEAR(most, 0.04F, 1e-4F);  // hair on the crown
  for (std::size_t t = 0; t < mesh.topology->triangles.size(); ++t) {
    const std::uint32_t v = mesh.topology->triangles[t][0];
    const float moved = (mesh.vertices[v] - bare().vertices[v]).norm();
    const int p = mesh.topology->part[t];
    EXPECT_TRUE(p != part("l_hand") || moved < 0.012F) << moved;
    const bool shin = p == part("l_leg") && bare().vertices[v].y() > 0.25F;
    EXPECT_TRUE(!shin || std::abs(moved - 0.015F) < 0.002F) << moved;
  }
}

TEST(Dress, KeepsFoldsBetweenSkinAndThickestCloth) {
  Outfit outfit;
  outfit.hair = Hair::bald;
  outfit.hair_m = 0.F;
  outfit.top_m = outfit.bottom_m = 0.02F;
  outfit.folds = 1.F;
  const BodyMesh mesh = dressed(outfit);
  float least = 1.F;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const float moved = (mesh.vertices[v] - bare().vertices[v]).norm();
    EXPECT_LT(moved, 0.0201F);
    if (std::abs(bare().vertices[v].y() - 1.2F) < 0.05F && std::abs(bare().vertices[v].x()) < 0.1F) {
      least = std::min(least, moved);
    }
  }
  EXPECT_LT(least, 0.017F);  // there are folds
}

TEST(Dress, GivesFabricsByTheOutfit) {
  Outfit outfit;
  outfit.sleeves = 0.5F;
  outfit.legs = 0.5F;
  outfit.shoes = false;
  const BodyMesh mesh = dressed(outfit);
  std::map<std::pair<int, Fabric>, int> count;
  for (std::size_t t = 0; t < mesh.topology->triangles.size(); ++t)
    ++count[{mesh.topology->part[t], mesh.topology->fabric[t]}];
  const auto has = [&](const char* name, Fabric fabric) { return count[{part(name), fabric}]; };
  EXPECT_EQ(has("l_forearm", Fabric::top), 0);
  EXPECT_EQ(has("l_upper_arm", Fabric::skin), 0);
  EXPECT_EQ(has("l_leg", Fabric::bottom), 0);
  EXPECT_EQ(has("l_thigh", Fabric::skin), 0);
  EXPECT_EQ(has("l_foot", Fabric::shoes), 0);
  EXPECT_GT(has("l_face_top", Fabric::hair), 50);
  EXPECT_GT(has("l_face_top", Fabric::skin), 5);  // the forehead
  EXPECT_GT(has("l_face_bottom", Fabric::skin), 20);
  EXPECT_GT(has("l_hips", Fabric::bottom), 50);
  EXPECT_GT(has("l_chest", Fabric::top), 50);
}

TEST(Dress, LabelsSkirtsAsTheLegsBeneath) {
  Outfit outfit;
  outfit.skirt = 0.8F;
  const BodyMesh mesh = dressed(outfit);
  EXPECT_THAT(added_parts(mesh),
              testing::UnorderedElementsAre(part("l_hips"), part("r_hips"), part("l_thigh"), part("r_thigh"),
                                            part("l_knee"), part("r_knee"), part("l_leg"), part("r_leg")));
  for (std::size_t t = mesh.topology->body_triangles; t < mesh.topology->triangles.size(); ++t) {
    const Triangle& tri = mesh.topology->triangles[t];
    const float x = mesh.vertices[tri[0]].x() + mesh.vertices[tri[2]].x();
    const char side = paper_body().parts[mesh.topology->part[t]].name.front();
    EXPECT_TRUE(std::abs(x) < 0.05F || side == (x > 0.F ? 'l' : 'r'));
  }
}

TEST(Dress, HidesTheThighsOfAStandingPersonBehindASkirt) {
  Outfit outfit;
  outfit.skirt = 0.6F;
  const BodyMesh mesh = dressed(outfit);
  float widest_leg = 0.F;
  float widest_skirt = 0.F;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (std::abs(mesh.vertices[v].y() - 0.7F) > 0.04F || mesh.vertices[v].x() > 0.35F) continue;
    float& widest = v < bare().vertices.size() ? widest_leg : widest_skirt;
    widest = std::max(widest, mesh.vertices[v].x());
  }
  EXPECT_GT(widest_skirt, widest_leg);
}

TEST(Dress, LabelsHatsAndHairAsTheHead) {
  Outfit outfit;
  for (const Hat hat : {Hat::beanie, Hat::cap, Hat::brimmed}) {
    outfit.hat = hat;
    const BodyMesh mesh = dressed(outfit);
    EXPECT_THAT(added_parts(mesh), testing::UnorderedElementsAre(part("l_face_top"), part("r_face_top")));
    const auto highest = std::ranges::max(mesh.vertices, {}, [](const Vector3f& p) { return p.y(); }).y();
    EXPECT_GT(highest, mesh.stature_m + 0.005F);
    EXPECT_LT(highest, mesh.stature_m + 0.15F);
  }
  outfit.hat = Hat::none;
  outfit.hair = Hair::long_hair;
  EXPECT_THAT(added_parts(dressed(outfit)), testing::IsSupersetOf({part("l_face_bottom"), part("r_face_bottom")}));
}

TEST(Dress, LabelsCarriedThingsAsNobodysAndMovesThemWithTheirBone) {
  Outfit outfit;
  outfit.held = Held::box;
  outfit.left_hand = false;  // so the thing is in the left hand
  const auto mesh = std::make_shared<const BodyMesh>(dressed(outfit));
  EXPECT_THAT(added_parts(*mesh), testing::ElementsAre(static_cast<int>(kBackground)));
  const Poser poser(mesh, paper_body());
  const auto gap = [&](const PosedBody& body) {
    const Vector3f& hand = body.joints[index(Bone::l_hand)];
    return (body.vertices.back() - hand).norm();
  };
  Random random(2);
  const float at_rest = gap(poser.pose({}));
  EXPECT_LT(at_rest, 0.6F);
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(gap(poser.pose(random_pose(random, 1.F))), at_rest, 1e-4F);
}

TEST(Dress, LetsABagHangDownWhateverTheArmDoes) {
  Outfit outfit;
  outfit.bag = Bag::in_hand;
  outfit.left_hand = true;
  const auto mesh = std::make_shared<const BodyMesh>(dressed(outfit));
  const Poser poser(mesh, paper_body());
  Random random(6);
  for (int i = 0; i < 20; ++i) {
    Pose pose = random_pose(random, 1.2F);
    pose[Bone::pelvis] = Eigen::AngleAxisf(0.3F * static_cast<float>(i), Vector3f::UnitY());  // upright, any heading
    const PosedBody body = poser.pose(pose);
    const Vector3f hand = body.ends[index(Bone::l_hand)];
    Vector3f middle = Vector3f::Zero();
    for (std::size_t v = bare().vertices.size(); v < body.vertices.size(); ++v) {
      middle += body.vertices[v] / static_cast<float>(body.vertices.size() - bare().vertices.size());
      EXPECT_LT(body.vertices[v].y(), hand.y() + 1e-3F);
    }
    EXPECT_NEAR(middle.x(), hand.x(), 1e-3F);
    EXPECT_NEAR(middle.z(), hand.z(), 1e-3F);
  }
}

TEST(Dress, KeepsAPersonWithABagOnTheFloor) {
  Outfit outfit;
  outfit.bag = Bag::in_hand;
  const auto mesh = std::make_shared<const BodyMesh>(dressed(outfit));
  Pose bow;  // the hands reach the floor, so the bag would be under it
  bow[Bone::spine] = Eigen::Quaternionf(Eigen::AngleAxisf(1.9F, Vector3f::UnitX()));
  for (const Bone arm : {Bone::l_upper_arm, Bone::r_upper_arm}) {
    const float side = arm == Bone::l_upper_arm ? 1.F : -1.F;
    bow[arm] = Eigen::Quaternionf(Eigen::AngleAxisf(-side * 1.5F, Vector3f::UnitY()));
  }
  const PosedBody body = Poser(mesh, paper_body()).pose(bow);
  const auto feet = std::min(body.joints[index(Bone::l_foot)].y(), body.joints[index(Bone::r_foot)].y());
  EXPECT_LT(feet, 0.12F);
}

/// Returns the bounds of what nobody owns on a posed body.
Eigen::AlignedBox3f carried_bounds(const BodyMesh& mesh, const PosedBody& body) {
  Eigen::AlignedBox3f bounds;
  for (std::size_t t = 0; t < mesh.topology->triangles.size(); ++t) {
    if (mesh.topology->part[t] != kBackground) continue;
    for (const std::uint32_t v : mesh.topology->triangles[t]) bounds.extend(body.vertices[v]);
  }
  return bounds;
}

TEST(Dress, KeepsUmbrellasBroomsAndCanesUprightInTheHand) {
  for (const Held held : {Held::umbrella, Held::broom, Held::cane}) {
    Outfit outfit;
    outfit.held = held;
    outfit.left_hand = false;  // it is at the left then
    const auto mesh = std::make_shared<const BodyMesh>(dressed(outfit));
    EXPECT_THAT(added_parts(*mesh), testing::ElementsAre(kBackground));
    const Poser poser(mesh, paper_body());
    for (const float raise : {-1.3F, 0.F, 1.F}) {
      Pose pose;
      pose[Bone::l_upper_arm] = Eigen::Quaternionf(Eigen::AngleAxisf(raise, Vector3f::UnitZ()));
      const PosedBody body = poser.pose(pose);
      const Eigen::AlignedBox3f bounds = carried_bounds(*mesh, body);
      const Vector3f hand = 0.5F * (body.joints[index(Bone::l_hand)] + body.ends[index(Bone::l_hand)]);
      EXPECT_LT((bounds.center() - hand).head<1>().norm(), 0.15F) << raise;
      EXPECT_LT(bounds.min().y(), hand.y() - 0.3F * mesh->stature_m);
      EXPECT_GT(bounds.max().y(), hand.y() - 0.05F);
      EXPECT_LT(bounds.sizes().x(), 0.45F);
    }
  }
}

TEST(Dress, LaysStrapsOnTheTrunkFromHipToShoulder) {
  Outfit outfit;
  outfit.bag = Bag::on_strap;
  const BodyMesh mesh = dressed(outfit);
  EXPECT_THAT(added_parts(mesh), testing::ElementsAre(kBackground));
  float highest = 0.F;
  for (std::size_t v = bare().vertices.size(); v < mesh.vertices.size(); ++v) {
    const Vector3f& p = mesh.vertices[v];
    highest = std::max(highest, p.y());
    float nearest = 1.F;
    for (const Vector3f& q : bare().vertices) nearest = std::min(nearest, (p - q).norm());
    EXPECT_TRUE(p.y() < 0.65F * mesh.stature_m || nearest < 0.09F) << nearest << " from the skin at " << p.transpose();
  }
  EXPECT_GT(highest, 0.78F * mesh.stature_m);
  EXPECT_LT(highest, 0.9F * mesh.stature_m);
}

TEST(Dress, FitsEverySampledOutfitToEverySampledBody) {
  for (std::uint64_t i = 0; i < 30; ++i) {
    Random random(12, i);
    const BodyMesh body = make_body(builtin_bodies(), sample_factors({}, random), paper_body());
    OutfitOptions options;
    options.skirt = options.coat = options.hat = options.backpack = options.bag = options.held = 0.5F;
    options.carried = 0.5F;
    const Outfit outfit = sample_outfit(options, random);
    const BodyMesh mesh = dress(body, outfit, paper_body(), random);
    EXPECT_EQ(mesh.topology->body_triangles, body.topology->triangles.size());
    EXPECT_LT(mesh.topology->triangles.size(), body.topology->triangles.size() + 4000);
    EXPECT_NO_THROW(check(mesh, paper_body()));
  }
}

TEST(Dress, IsTheSameForTheSameSeedAndRefusesADressedBody) {
  Outfit outfit;
  outfit.backpack = true;
  EXPECT_EQ(dressed(outfit, 3).vertices, dressed(outfit, 3).vertices);
  EXPECT_NE(dressed(outfit, 3).vertices, dressed(outfit, 4).vertices);
  Random random(1);
  EXPECT_THROW(dress(dressed(outfit), outfit, paper_body(), random), Error);
}

}  // namespace
}  // namespace vesalius::synth
