#include "vesalius/grow_person.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capsule/capsule_person.h"
#include "vesalius/base/random.h"
#include "vesalius/planes/find_planes.h"

namespace vesalius {
namespace {

const Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

/// A scene with its true labels, proposals made from some of its parts, and one rough skeleton for each person.
struct Scene {
  LabelledFrame truth;
  Clusters clusters;
  std::vector<Skeleton> rough;
};

/// `seen` names the parts of the rough skeleton.
Scene make_scene(const CapsuleScene& capsules, const std::vector<std::string>& seen) {
  Scene scene;
  scene.truth = render(capsules, kCamera, paper_body());
  const BodyModel& body = paper_body();
  for (std::size_t p = 0; p < capsules.people.size(); ++p) {
    LabelImage labels = scene.truth.labels;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (scene.truth.person[i] != p) labels[i] = kBackground;
    }
    const Clusters mine = find_clusters(labels, scene.truth.frame.depth, kCamera, body, {});
    Skeleton skeleton;
    skeleton.parts.resize(body.parts.size());
    const auto first = static_cast<int>(scene.clusters.items.size());
    for (std::size_t c = 0; c < mine.items.size(); ++c) {
      const auto label = static_cast<std::size_t>(mine.items[c].label);
      if (std::ranges::find(seen, body.parts[label].name) == seen.end()) continue;
      SkeletonPart& part = skeleton.parts[label];
      if (part.state == State::observed) continue;
      part.state = State::observed;
      part.cluster = first + static_cast<int>(c);
      part.centre = mine.items[c].centroid;
    }
    if (scene.clusters.index.empty()) scene.clusters.index = Image<std::int32_t>(kCamera.width, kCamera.height, -1);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (mine.index[i] >= 0) scene.clusters.index[i] = first + mine.index[i];
    }
    scene.clusters.items.insert(scene.clusters.items.end(), mine.items.begin(), mine.items.end());
    scene.rough.push_back(skeleton);
  }
  return scene;
}

const std::vector<std::string> kHalf{"neck",       "l_chest",   "r_chest",     "l_hips",      "r_hips",
                                     "l_face_top", "r_forearm", "l_upper_arm", "r_upper_arm", "l_thigh",
                                     "r_thigh",    "r_leg",     "l_forearm",   "l_leg"};

struct Overlap {
  double iou = 0.0;
  long leaked = 0;  ///< mask pixels outside the person
  long person = 0;
};

Overlap compare(const Mask& mask, const Image<std::uint8_t>& person, int who) {
  Overlap o;
  long both = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    o.person += person[i] == who ? 1 : 0;
    both += person[i] == who && mask[i] != 0 ? 1 : 0;
    o.leaked += person[i] != who && mask[i] != 0 ? 1 : 0;
  }
  o.iou = static_cast<double>(both) / static_cast<double>(o.person + o.leaked);
  return o;
}

std::vector<Mask> grow_all(const Scene& scene, const GrowOptions& options = {}) {
  const Mask flat = flat_pixels(scene.truth.frame.depth, kCamera, options.plane);
  const auto appearance = make_appearance(options.appearance);
  const Looks looks = look_at(scene.truth.frame, appearance.get());
  return PersonGrower(scene.truth.frame, flat, paper_body(), options, looks).grow(scene.rough, scene.clusters);
}

TEST(GrowPerson, FillsTheWholePersonFromHalfOfTheParts) {
  CapsuleScene capsules;
  capsules.people.emplace_back();
  const Scene scene = make_scene(capsules, kHalf);
  const Overlap o = compare(grow_all(scene)[0], scene.truth.person, 0);
  EXPECT_GT(o.iou, 0.97);
}

TEST(GrowPerson, DoesNotLeakIntoTheFloor) {
  CapsuleScene capsules;
  capsules.people.emplace_back();
  capsules.pitch = 0.3F;
  capsules.floor_y_m = 1.4F;
  capsules.people[0].feet.y() = 1.4F;
  const Scene scene = make_scene(capsules, kHalf);
  const Overlap o = compare(grow_all(scene)[0], scene.truth.person, 0);
  EXPECT_LT(o.leaked, o.person / 100);
  EXPECT_GT(o.iou, 0.95);
}

TEST(GrowPerson, DoesNotLeakIntoAWallAtTheBack) {
  CapsuleScene capsules;
  capsules.people.emplace_back();
  capsules.wall_z_m = 2.62F;  // the back of the trunk touches it
  const Scene scene = make_scene(capsules, kHalf);
  const Overlap o = compare(grow_all(scene)[0], scene.truth.person, 0);
  EXPECT_LT(o.leaked, o.person / 50);
  EXPECT_GT(o.iou, 0.93);
}

TEST(GrowPerson, GivesTouchingNeighboursTheirOwnPixels) {
  CapsuleScene capsules;
  capsules.people.resize(2);
  capsules.people[0].feet = {-0.22F, 1.F, 2.5F};
  capsules.people[1].feet = {0.22F, 1.F, 2.52F};  // shoulder to shoulder
  const Scene scene = make_scene(capsules, kHalf);
  const std::vector<Mask> masks = grow_all(scene);
  for (int who = 0; who < 2; ++who) {
    const Overlap o = compare(masks[who], scene.truth.person, who);
    EXPECT_LT(o.leaked, o.person / 25) << who;
    EXPECT_GT(o.iou, 0.93) << who;
  }
  for (std::size_t i = 0; i < masks[0].size(); ++i) ASSERT_FALSE(masks[0][i] != 0 && masks[1][i] != 0);
}

TEST(GrowPerson, ReachesAnUnseenLimbButNotAcrossTheRoom) {
  CapsuleScene capsules;
  capsules.people.emplace_back();
  capsules.people[0].pose.l_arm.raise = 1.5F;  // stretched out sideways
  // The box touches the hand and extends for two metres.
  capsules.boxes.push_back({{0.7F, -0.6F, 2.45F}, {3.F, -0.2F, 2.55F}, {90, 160, 90}});
  const Scene scene = make_scene(capsules, kHalf);
  const Mask mask = grow_all(scene)[0];
  long on_box_far = 0;
  for (int v = 0; v < mask.height(); ++v) {
    for (int u = 0; u < mask.width(); ++u) {
      if (mask(u, v) == 0) continue;
      const float x = kCamera
                          .point(static_cast<float>(u), static_cast<float>(v),
                                 static_cast<float>(scene.truth.frame.depth(u, v)) * 1e-3F)
                          .x();
      on_box_far += x > 1.3F ? 1 : 0;
    }
  }
  EXPECT_EQ(on_box_far, 0);
}

/// Returns a person with a red box against the outer side of a leg, without a gap in depth.
CapsuleScene person_with_box() {
  CapsuleScene capsules;
  capsules.people.emplace_back();
  capsules.people[0].build.trousers = {40, 60, 200};
  capsules.boxes.push_back({{0.15F, 0.15F, 2.46F}, {0.6F, 0.7F, 2.6F}, {210, 40, 30}});
  return capsules;
}

std::vector<std::string> all_parts() {
  std::vector<std::string> names;
  for (const BodyPart& part : paper_body().parts) names.push_back(part.name);
  return names;
}

TEST(GrowPerson, StopsAtOtherColoursWhereDepthIsContinuous) {
  // Every part is known, so the box cannot be an unseen limb.
  const Scene scene = make_scene(person_with_box(), all_parts());
  GrowOptions blind;
  blind.appearance = "none";
  const long with = compare(grow_all(scene)[0], scene.truth.person, 0).leaked;
  const long without = compare(grow_all(scene, blind)[0], scene.truth.person, 0).leaked;
  EXPECT_GT(without, 200);  // depth alone lets the mask grow onto the box
  EXPECT_LT(with, without / 2);
}

TEST(GrowPerson, StopsAtOtherTexturesOfTheSameHue) {
  CapsuleScene capsules = person_with_box();
  // The whole room has the colour of the trousers, in stripes.
  capsules.boxes[0].colour = capsules.floor_colour = capsules.wall_colour = capsules.people[0].build.trousers;
  Scene scene = make_scene(capsules, all_parts());
  ColourImage& colour = scene.truth.frame.colour;
  for (int v = 0; v < colour.height(); ++v) {
    for (int u = 0; u < colour.width(); u += 2) {
      if (scene.truth.person(u, v) == 0) continue;
      const Rgb plain = colour(u, v);
      colour(u, v) = {static_cast<std::uint8_t>(plain.r / 2), static_cast<std::uint8_t>(plain.g / 2),
                      static_cast<std::uint8_t>(plain.b / 2)};
    }
  }
  GrowOptions texture;
  texture.appearance = "texture";
  const long by_hue = compare(grow_all(scene)[0], scene.truth.person, 0).leaked;
  const long by_texture = compare(grow_all(scene, texture)[0], scene.truth.person, 0).leaked;
  EXPECT_GT(by_hue, 200);
  EXPECT_LT(by_texture, by_hue / 2);
}

TEST(GrowPerson, WorksWithoutColour) {
  Scene scene = make_scene(person_with_box(), kHalf);
  GrowOptions blind;
  blind.appearance = "none";
  const std::vector<Mask> expected = grow_all(scene, blind);
  scene.truth.frame.colour = {};
  EXPECT_EQ(grow_all(scene), expected);
}

TEST(GrowPerson, StopsAtKnownColoursIfTheSeedsHaveTooFew) {
  // This frame shows too little of the person to learn colours from it.
  const Scene scene = make_scene(person_with_box(), {"l_knee"});
  const Mask flat = flat_pixels(scene.truth.frame.depth, kCamera, {});
  GrowOptions options;
  options.reach_m = 0.5F;
  options.own_look_m = 0.01F;
  const HueAppearance hue;
  const Looks looks = look_at(scene.truth.frame, &hue);
  const PersonGrower grower(scene.truth.frame, flat, paper_body(), options, looks);
  Mask person(kCamera.width, kCamera.height, 0);
  for (std::size_t i = 0; i < person.size(); ++i) person[i] = scene.truth.person[i] == 0 ? 1 : 0;
  const AppearanceHistogram known = learn_appearance(scene.truth.frame, person, hue);
  EXPECT_EQ(known.samples(), std::ranges::count(person, 1));
  const long without = compare(grower.grow(scene.rough, scene.clusters)[0], scene.truth.person, 0).leaked;
  const long with = compare(grower.grow(scene.rough, scene.clusters, {known})[0], scene.truth.person, 0).leaked;
  EXPECT_GT(without, 200);
  EXPECT_LT(with, without / 2);
  EXPECT_EQ(grower.grow(scene.rough, scene.clusters, {AppearanceHistogram{}}),
            grower.grow(scene.rough, scene.clusters));
  Mask clustered(kCamera.width, kCamera.height, 0);
  std::ranges::transform(scene.clusters.index, clustered.begin(), [](int one) { return std::uint8_t{one >= 0}; });
  EXPECT_EQ(grower.grow(scene.rough[0], grower.reach_of(scene.rough[0]), scene.clusters, bounding_box(clustered)),
            grower.grow({scene.rough[0]}, scene.clusters)[0]);
}

}  // namespace
}  // namespace vesalius
