#include "sample_sequence.h"

#include <cmath>
#include <string>

#include "capsule/capsule_person.h"

namespace vesalius {
namespace {

constexpr int kFrames = 8;
constexpr float kFramesPerSecond = 10.F;
constexpr float kFloorY = 1.2F;

CapsulePerson waving(float time_s) {
  CapsulePerson person;
  person.feet = {0.05F, kFloorY, 2.3F};
  person.build.shirt = {52, 101, 164};
  person.pose.yaw = -0.1F;
  person.pose.r_arm = {1.5F, 1.5F, 1.1F + 0.5F * std::sin(6.F * time_s)};
  person.pose.l_leg.spread = person.pose.r_leg.spread = 0.08F;
  return person;
}

CapsulePerson walking(float time_s) {
  CapsulePerson person;
  person.feet = {-1.55F + 0.9F * time_s, kFloorY, 3.1F};
  person.build.stature_m = 1.65F;
  person.build.shirt = {170, 50, 45};
  person.build.trousers = {40, 70, 110};
  person.pose.yaw = 0.9F;
  const float swing = 0.45F * std::sin(6.F * time_s), lift = std::cos(6.F * time_s);
  person.pose.l_leg = {0.03F, swing, 0.25F - 0.25F * lift};
  person.pose.r_leg = {0.03F, -swing, 0.25F + 0.25F * lift};
  person.pose.l_arm = {0.05F, -swing, 0.3F};
  person.pose.r_arm = {0.05F, swing, 0.3F};
  return person;
}

CapsulePerson half_hidden() {
  CapsulePerson person;
  person.feet = {1.15F, kFloorY, 2.9F};
  person.build.stature_m = 1.82F;
  person.build.girth = 1.1F;
  person.build.shirt = {70, 140, 70};
  person.pose.yaw = 0.2F;
  person.pose.l_arm = {0.3F, 0.2F, 0.5F};
  person.pose.r_arm = {0.2F, 0.6F, 1.F};
  return person;
}

}  // namespace

std::vector<LabelledFrame> sample_sequence() {
  const Camera camera{640, 480, 525.F, 525.F, 319.5F, 239.5F};
  std::vector<LabelledFrame> frames;
  for (int i = 0; i < kFrames; ++i) {
    const float time_s = static_cast<float>(i) / kFramesPerSecond;
    CapsuleScene scene;
    scene.floor_y_m = kFloorY;
    scene.wall_z_m = 4.2F;
    scene.pitch = 0.08F;
    scene.people = {waving(time_s), walking(time_s), half_hidden()};
    scene.boxes.push_back({{0.75F, kFloorY - 0.75F, 2.3F}, {1.5F, kFloorY, 2.5F}, {150, 120, 90}});
    scene.boxes.push_back({{-2.4F, kFloorY - 0.9F, 3.7F}, {-1.9F, kFloorY, 4.2F}, {110, 90, 70}});
    LabelledFrame labelled = render(scene, camera, paper_body());
    labelled.frame.name = "00" + std::to_string(i);
    labelled.frame.time_s = i / static_cast<double>(kFramesPerSecond);
    add_sensor_noise(labelled.frame, static_cast<std::uint64_t>(i));
    frames.push_back(std::move(labelled));
  }
  return frames;
}

}  // namespace vesalius
