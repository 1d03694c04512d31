// These tests run the bundled forest on scenes from which it did not learn: labelling, both passes, and the whole
// detector with default options.

#include <gmock/gmock.h>

#include <algorithm>
#include <iostream>

#include "capsule/capsule_person.h"
#include "vesalius/base/random.h"
#include "vesalius/detect.h"
#include "vesalius/find_clusters.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

const Camera kCamera{640, 480, 525.F, 525.F, 319.5F, 239.5F};

Detector bundled_detector() {
  return Detector(load_model(std::string(VESALIUS_SOURCE_DIR) + "/data/models/capsule.forest"));
}

CapsulePerson random_person(Random& random, float x, float z, float floor_y) {
  CapsulePerson person;
  person.build.stature_m = static_cast<float>(random.uniform(1.6, 1.9));
  person.pose.yaw = static_cast<float>(random.uniform(-0.5, 0.5));
  for (auto* arm : {&person.pose.l_arm, &person.pose.r_arm}) {
    arm->raise = static_cast<float>(random.uniform(0.0, 1.2));
    arm->forward = static_cast<float>(random.uniform(0.0, 0.6));
    arm->elbow = static_cast<float>(random.uniform(0.0, 1.2));
  }
  person.feet = {x, floor_y, z};
  return person;
}

CapsuleScene room(float wall_z_m) {
  CapsuleScene scene;
  scene.floor_y_m = 1.1F;
  scene.wall_z_m = wall_z_m;
  return scene;
}

TEST(CapsuleForest, PutsPartsWhereTheyAreSeen) {
  const Detector detector = bundled_detector();
  int visible = 0, found = 0, within_4cm = 0, within_10cm = 0, people = 0;
  constexpr int kScenes = 12;
  for (int i = 0; i < kScenes; ++i) {
    Random random(77, static_cast<std::uint64_t>(i));
    const auto z = static_cast<float>(random.uniform(2.0, 4.0));
    CapsuleScene scene = room(z + 1.F);
    scene.people.push_back(random_person(random, 0.F, z, scene.floor_y_m));
    LabelledFrame truth = render(scene, kCamera, detector.body());
    if (i % 2 == 1) add_sensor_noise(truth.frame, static_cast<std::uint64_t>(i));
    const std::vector<Person> got = detector.detect(truth.frame);
    people += static_cast<int>(got.size());
    if (got.empty()) continue;
    const Clusters clusters = find_clusters(truth.labels, truth.frame.depth, kCamera, detector.body(), {});
    for (int part = 0; part < detector.body().part_count(); ++part) {
      const auto seen = std::ranges::find_if(clusters.items, [&](const PartCluster& c) { return c.label == part; });
      if (seen == clusters.items.end() || seen->area_m2 < 0.004F) continue;
      ++visible;
      const SkeletonPart& p = got[0].skeleton.parts[part];
      if (p.state == State::none) continue;
      ++found;
      const float error_m = (p.centre - seen->centroid).norm();
      within_4cm += error_m < 0.04F ? 1 : 0;
      within_10cm += error_m < 0.1F ? 1 : 0;
    }
  }
  std::cout << "capsule scenes: " << people << " people in " << kScenes << " frames with one; of " << visible
            << " visible parts " << found << " found, " << within_4cm << " within 4 cm, " << within_10cm
            << " within 10 cm\n";
  EXPECT_EQ(people, kScenes);
  EXPECT_GE(within_4cm, 0.8 * visible);
  EXPECT_GE(within_10cm, 0.93 * visible);
}

TEST(CapsuleForest, FindsAllOfThreePeople) {
  const Detector detector = bundled_detector();
  for (int i = 0; i < 4; ++i) {
    Random random(5, static_cast<std::uint64_t>(i));
    CapsuleScene scene = room(5.F);
    scene.people.push_back(random_person(random, -0.9F, 2.6F, scene.floor_y_m));
    scene.people.push_back(random_person(random, 0.2F, 3.2F, scene.floor_y_m));
    scene.people.push_back(random_person(random, 1.2F, 2.9F, scene.floor_y_m));
    LabelledFrame truth = render(scene, kCamera, detector.body());
    add_sensor_noise(truth.frame, static_cast<std::uint64_t>(i));
    EXPECT_EQ(detector.detect(truth.frame).size(), 3U) << "scene " << i;
  }
}

TEST(CapsuleForest, FindsNobodyInEmptyRooms) {
  const Detector detector = bundled_detector();
  for (int i = 0; i < 8; ++i) {
    Random random(9, static_cast<std::uint64_t>(i));
    CapsuleScene scene = room(static_cast<float>(random.uniform(3.0, 5.0)));
    for (int b = 0; b < 4; ++b) {
      const auto x = static_cast<float>(random.uniform(-1.5, 1.5));
      const auto z = static_cast<float>(random.uniform(1.5, 3.5));
      const auto top = static_cast<float>(random.uniform(-0.6, 0.8));
      scene.boxes.push_back({{x, top, z}, {x + 0.5F, 1.1F, z + 0.4F}, {140, 110, 80}});
    }
    LabelledFrame truth = render(scene, kCamera, detector.body());
    add_sensor_noise(truth.frame, static_cast<std::uint64_t>(i));
    EXPECT_TRUE(detector.detect(truth.frame).empty()) << "scene " << i;
  }
}

}  // namespace
}  // namespace vesalius
