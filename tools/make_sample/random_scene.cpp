#include "random_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

class SceneMaker {
 public:
  SceneMaker(std::uint64_t seed, std::uint64_t index) : random_(seed, index) {}

  CapsuleScene make() {
    scene_.floor_y_m = range(0.6F, 2.F);
    scene_.pitch = range(-0.1F, 0.1F) + 0.25F * (scene_.floor_y_m - 0.9F);
    add_people();
    make_room();
    const int boxes = random_.below(8);
    for (int i = 0; i < boxes; ++i) add_furniture();
    if (!scene_.people.empty() && chance(0.2)) add_occluder();
    return std::move(scene_);
  }

 private:
  float range(float low, float high) { return static_cast<float>(random_.uniform(low, high)); }
  float normal(float sigma) { return static_cast<float>(random_.normal(0.0, sigma)); }
  bool chance(double probability) { return random_.uniform() < probability; }
  Rgb colour() {
    const auto channel = [&] { return static_cast<std::uint8_t>(40 + random_.below(180)); };
    return {channel(), channel(), channel()};
  }

  void add_people() {
    const double draw = random_.uniform();
    const int wanted = draw < 0.12 ? 0 : draw < 0.60 ? 1 : draw < 0.85 ? 2 : 3;
    for (int i = 0; i < wanted; ++i) {
      CapsulePerson person = make_person();
      const auto crowds = [&](const CapsulePerson& other) { return (other.feet - person.feet).norm() < 0.75F; };
      if (std::ranges::any_of(scene_.people, crowds)) continue;
      if (sits_) add_seat(person);
      scene_.people.push_back(person);
    }
  }

  CapsulePerson make_person() {
    CapsulePerson person;
    person.build.stature_m = range(1.5F, 1.95F);
    person.build.girth = range(0.85F, 1.3F);
    person.build.shirt = colour();
    person.build.trousers = colour();
    const float z_m = 1.F + 3.5F * std::sqrt(range(0.F, 1.F));  // as many per square metre near as far
    person.feet = {range(-0.55F, 0.55F) * z_m, scene_.floor_y_m, z_m};
    CapsulePose& pose = person.pose;
    pose.yaw = chance(0.75) ? range(-kPi / 3.F, kPi / 3.F) : range(-kPi, kPi);
    pose.lean = std::abs(normal(0.1F)) + (chance(0.1) ? range(0.F, 0.6F) : 0.F);
    pose.side_lean = normal(0.07F);
    pose.head_yaw = std::clamp(normal(0.3F), -1.F, 1.F);
    pose.head_pitch = std::clamp(normal(0.2F), -0.6F, 0.6F);
    pose_legs(pose);
    pose_arm(pose.l_arm);
    pose_arm(pose.r_arm);
    if (chance(0.1)) pose.r_arm = pose.l_arm;
    return person;
  }

  void pose_legs(CapsulePose& pose) {
    const double draw = random_.uniform();
    sits_ = draw > 0.85;
    if (draw < 0.5) {  // stands
      for (CapsulePose::Leg* leg : {&pose.l_leg, &pose.r_leg}) {
        *leg = {range(0.F, 0.2F), normal(0.06F), std::abs(normal(0.08F))};
      }
    } else if (!sits_) {  // walks
      const float phase = range(0.F, 2.F * kPi), swing = range(0.2F, 0.6F);
      pose.l_leg = {range(0.F, 0.08F), swing * std::sin(phase), swing * (0.6F - 0.6F * std::cos(phase))};
      pose.r_leg = {range(0.F, 0.08F), -swing * std::sin(phase), swing * (0.6F + 0.6F * std::cos(phase))};
    } else {
      for (CapsulePose::Leg* leg : {&pose.l_leg, &pose.r_leg}) {
        *leg = {range(0.F, 0.3F), range(1.2F, 1.6F), range(1.2F, 1.7F)};
      }
    }
  }

  void pose_arm(CapsulePose::Arm& arm) {
    const double draw = random_.uniform();
    if (draw < 0.35) {  // hangs or swings
      arm = {std::abs(normal(0.15F)), normal(0.35F), std::abs(normal(0.4F))};
    } else if (draw < 0.55) {  // waves
      arm = {range(1.F, 1.9F), range(1.F, 1.9F), range(0.2F, 2.2F)};
    } else if (draw < 0.65) {  // up
      arm = {range(2.F, 3.1F), range(-0.3F, 0.5F), range(0.F, 0.8F)};
    } else if (draw < 0.8) {  // to the side
      arm = {range(0.5F, 2.F), range(-0.5F, 0.8F), range(0.F, 1.F)};
    } else {  // to the front
      arm = {range(-0.1F, 0.7F), range(0.5F, 2.2F), range(0.F, 2.F)};
    }
  }

  /// A box under the hips, as wide as a stool.
  void add_seat(const CapsulePerson& person) {
    const std::vector<BodySolid> solids = make_solids(person);
    const std::vector<Eigen::Vector3d> centres = part_centres(solids);
    const auto centre = [&](const char* part) { return centres[paper_body().find_part(part)].cast<float>().eval(); };
    const Eigen::Vector3f hips = 0.5F * (centre("l_hips") + centre("r_hips"));
    const float top_y = std::min(hips.y() + range(0.12F, 0.2F), scene_.floor_y_m - 0.05F);
    const float half_m = range(0.15F, 0.25F);
    add_box({hips.x() - half_m, top_y, hips.z() - 0.8F * half_m},
            {hips.x() + half_m, scene_.floor_y_m, hips.z() + half_m});
  }

  void add_box(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    scene_.boxes.push_back({low.cwiseMin(high), high.cwiseMax(low), colour()});
  }

  void make_room() {
    float furthest_m = 1.5F;
    for (const CapsulePerson& person : scene_.people) furthest_m = std::max(furthest_m, person.feet.z());
    scene_.wall_z_m = chance(0.9) ? furthest_m + range(0.4F, 3.F) : 0.F;
    if (chance(0.5)) scene_.side_wall_x_m = range(2.8F, 4.5F);
    scene_.floor_colour = colour();
    scene_.wall_colour = colour();
  }

  /// Whether a box of this footprint would stand in somebody.
  bool touches_person(const Eigen::Vector3f& low, const Eigen::Vector3f& high) const {
    return std::ranges::any_of(scene_.people, [&](const CapsulePerson& person) {
      constexpr float kRoom = 0.45F;
      return person.feet.x() > low.x() - kRoom && person.feet.x() < high.x() + kRoom &&
             person.feet.z() > low.z() - kRoom && person.feet.z() < high.z() + kRoom;
    });
  }

  /// Tables, cupboards, posts, shelves and table-tops in mid-air.
  void add_furniture() {
    const float z_m = range(1.F, 5.5F);
    const bool post = chance(0.3);
    const Eigen::Vector3f size = post ? Eigen::Vector3f(range(0.05F, 0.3F), range(0.6F, 2.5F), range(0.05F, 0.3F))
                                      : Eigen::Vector3f(range(0.1F, 1.2F), range(0.05F, 1.3F), range(0.1F, 0.8F));
    const float bottom_y = chance(0.7) ? scene_.floor_y_m : scene_.floor_y_m - range(0.F, 1.8F);
    const Eigen::Vector3f low(range(-0.8F, 0.8F) * z_m - 0.5F * size.x(), bottom_y - size.y(), z_m);
    const Eigen::Vector3f high(low.x() + size.x(), bottom_y, z_m + size.z());
    if (!touches_person(low, high)) add_box(low, high);
  }

  /// Something between the camera and a person.
  void add_occluder() {
    const CapsulePerson& person = scene_.people[random_.below(static_cast<std::uint32_t>(scene_.people.size()))];
    const Eigen::Vector3f centre = range(0.35F, 0.75F) * person.feet;
    const Eigen::Vector3f size(range(0.1F, 0.8F), range(0.1F, 0.9F), range(0.05F, 0.2F));
    const float top_y = scene_.floor_y_m - size.y() - (chance(0.3) ? range(0.F, 0.8F) : 0.F);
    const float left_x = centre.x() + range(-0.3F, 0.3F) - 0.5F * size.x();
    const Eigen::Vector3f low(left_x, top_y, centre.z());
    const Eigen::Vector3f high(left_x + size.x(), top_y + size.y(), centre.z() + size.z());
    if (centre.z() > 0.6F && !touches_person(low, high)) add_box(low, high);
  }

  Random random_;
  CapsuleScene scene_;
  bool sits_ = false;
};

}  // namespace

CapsuleScene random_scene(std::uint64_t seed, std::uint64_t index) { return SceneMaker(seed, index).make(); }

LabelledFrame random_frame(const Camera& camera, std::uint64_t seed, std::uint64_t index) {
  LabelledFrame labelled = render(random_scene(seed, index), camera, paper_body());
  labelled.frame.name = std::to_string(index);
  labelled.frame.colour = {};
  if (index % 2 == 1) add_sensor_noise(labelled.frame, seed + index);
  return labelled;
}

}  // namespace vesalius
