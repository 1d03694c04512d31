#include "synth/pose/pose_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>

#include "synth/pose/floor_contact.h"
#include "synth/pose/pose_kinds.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kMaxWeight = 1000.F;
/// At least one in three draws of a kind is possible (measured: one in three for people who sit on the floor, more for
/// others), so that many tries never fail.
constexpr int kTries = 300;

struct Kind {
  const char* name;
  float PoseSamplerOptions::*weight;
  std::optional<Pose> (*draw)(Random&);  ///< nothing if a draw does not hold
  std::optional<Posture> posture;        ///< empty if it follows from the pose
  const char* help;
  bool to_floor = false;  ///< whether people are on their way to or from the floor, without a seat
};

template <Pose (*kDraw)(Random&)>
std::optional<Pose> always(Random& random) {
  return kDraw(random);
}

using P = Posture;
using O = PoseSamplerOptions;
constexpr std::array<Kind, 28> kKinds{{
    {"idle", &O::idle, always<kinds::idle>, P::standing, "Weight of people who stand about."},
    {"walking", &O::walking, always<kinds::walking>, P::standing, "Weight of people who walk."},
    {"reaching", &O::reaching, always<kinds::reaching>, P::standing,
     "Weight of people who reach for something or point."},
    {"waving", &O::waving, always<kinds::waving>, P::standing, "Weight of people who wave."},
    {"bending", &O::bending, always<kinds::bending>, P::standing, "Weight of people who bend down."},
    {"arms-crossed", &O::arms_crossed, always<kinds::arms_crossed>, P::standing, "Weight of people with crossed arms."},
    {"arms-behind", &O::arms_behind, always<kinds::arms_behind>, P::standing,
     "Weight of people with their hands behind them."},
    {"hands-on-hips", &O::hands_on_hips, always<kinds::hands_on_hips>, P::standing,
     "Weight of people with hands on hips."},
    {"carrying", &O::carrying, always<kinds::carrying>, P::standing, "Weight of people who carry something."},
    {"phone", &O::phone, always<kinds::phone>, P::standing,
     "Weight of people with a telephone at the ear or in the hand."},
    {"sitting", &O::sitting, always<kinds::sitting>, P::sitting, "Weight of people who sit on chairs and sofas."},
    {"floor-sitting", &O::floor_sitting, always<kinds::floor_sitting>, P::sitting,
     "Weight of people who sit on the floor."},
    {"lying", &O::lying, always<kinds::lying>, P::lying, "Weight of people who lie on back, side or front."},
    {"kneeling", &O::kneeling, always<kinds::kneeling>, P::kneeling,
     "Weight of people on one knee, both, or all fours."},
    {"squatting", &O::squatting, always<kinds::squatting>, P::standing, "Weight of people who squat."},
    {"crawling", &O::crawling, kinds::crawling, P::kneeling, "Weight of people who crawl on hands or forearms."},
    {"getting-up", &O::getting_up, kinds::getting_up, std::nullopt,
     "Weight of moments between lying, sitting on the floor, kneeling, squatting and standing.", true},
    {"turning-over", &O::turning_over, kinds::turning_over, P::lying,
     "Weight of moments between lying on back, side and front."},
    {"falling", &O::falling, kinds::falling, std::nullopt, "Weight of moments of falls.", true},
    {"sitting-up", &O::sitting_up, kinds::sitting_up, std::nullopt,
     "Weight of people on the floor who lean on hands or an elbow, stretch the legs, hug their knees or sit sideways."},
    {"lying-varied", &O::lying_varied, kinds::lying_varied, P::lying,
     "Weight of people who lie curled up, arms over the head, legs crossed, a knee drawn up, on the elbows or half on "
     "the front."},
    {"picking-up", &O::picking_up, kinds::picking_up, std::nullopt,
     "Weight of people who pick things up, tie shoes or look under something."},
    {"drinking", &O::drinking, always<kinds::drinking>, std::nullopt, "Weight of people who hold a cup or drink."},
    {"handing", &O::handing, always<kinds::handing>, std::nullopt, "Weight of people who hand something over."},
    {"hands-together", &O::hands_together, always<kinds::hands_together>, std::nullopt,
     "Weight of people with hands in the lap, before the belly, clasped, or in prayer."},
    {"hands-on-self", &O::hands_on_self, always<kinds::touching_oneself>, std::nullopt,
     "Weight of people with folded arms or hands on head, face, neck, chest or knees."},
    {"leaning", &O::leaning, always<kinds::leaning>, std::nullopt,
     "Weight of people who lean with both hands on a table, or with their elbows on the knees."},
    {"any", &O::any, always<kinds::any>, std::nullopt, "Weight of joints drawn uniformly from all that they can do."},
}};

const Kind& draw_kind(const PoseSamplerOptions& options, Random& random) {
  float total = 0.F;
  for (const Kind& kind : kKinds) {
    const float weight = options.*kind.weight;
    if (!(weight >= 0.F && weight <= kMaxWeight)) {
      throw UsageError(fmt::format("pose sampler: weight of {}: expected 0 to {}", kind.name, kMaxWeight));
    }
    total += weight;
  }
  if (!(total > 0.F)) throw UsageError("pose sampler: expected at least one weight above 0");
  float left = float(random.uniform()) * total;
  const Kind* last = nullptr;
  for (const Kind& kind : kKinds) {
    if (options.*kind.weight <= 0.F) continue;
    last = &kind;
    left -= options.*kind.weight;
    if (left < 0.F) break;
  }
  return *last;
}

bool possible(const Pose& pose, float touch_m) {
  return arm_in_range(arm_angles(pose, true)) && arm_in_range(arm_angles(pose, false)) &&
         !intersects_itself(pose, touch_m);
}

/// Returns the posture of a pose of a kind. Those on the way to the floor who seem to sit but are not down yet are on
/// their feet: no seat belongs under them.
Posture posture_of(const Kind& kind, const Pose& pose) {
  constexpr float kLow_m = 0.1F;
  const Posture posture = classify_posture(pose);
  if (posture != Posture::sitting || !kind.to_floor) return posture;
  return *skin_height_m(pose, Bone::pelvis) > kLow_m ? Posture::standing : posture;
}

void take(Pose& pose, const Pose& other, std::initializer_list<Bone> bones) {
  for (const Bone bone : bones) pose[bone] = other[bone];
}

Limbs draw_limbs(Random& random) {
  const std::uint32_t bits = 1 + random.below(15);
  return {(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0};
}

SampledPose draw_mixed(std::span<const SampledPose> poses, const SampledPose& base, float touch_m, Random& random) {
  constexpr int kMixes = 20;
  for (int i = 0; i < kMixes; ++i) {
    const SampledPose& other = poses[random.below(static_cast<std::uint32_t>(poses.size()))];
    const Limbs limbs = draw_limbs(random);
    if (other.posture != base.posture) continue;
    const Pose mixed = mix_limbs(base.pose, other.pose, limbs);
    if (!intersects_itself(mixed, touch_m) && classify_posture(mixed) == base.posture) return {mixed, base.posture};
  }
  return base;
}

}  // namespace

void visit_options(const std::string& prefix, PoseSamplerOptions& options, OptionVisitor& visitor) {
  for (const Kind& kind : kKinds)
    visitor.option(prefix + kind.name, options.*kind.weight, {"", 0.0, kMaxWeight, kind.help});
}

PoseSamplerOptions only(float PoseSamplerOptions::*kind) {
  PoseSamplerOptions options;
  for (const Kind& other : kKinds) options.*other.weight = 0.F;
  options.*kind = 1.F;
  return options;
}

SampledPose sample_pose(const PoseSamplerOptions& options, Random& random, float touch_m) {
  const Kind& kind = draw_kind(options, random);
  for (int i = 0; i < kTries; ++i) {
    const std::optional<Pose> pose = kind.draw(random);
    if (!pose || !possible(*pose, touch_m)) continue;
    const Posture posture = posture_of(kind, *pose);
    if (!kind.posture || posture == *kind.posture) return {*pose, posture};
  }
  return {pose_of({}), Posture::standing};
}

Pose mix_limbs(const Pose& pose, const Pose& other, const Limbs& limbs) {
  Pose out = pose;
  if (limbs.l_arm) {
    take(out, other, {Bone::l_clavicle, Bone::l_upper_arm, Bone::l_forearm, Bone::l_hand});
    out.l_grip = other.l_grip;
  }
  if (limbs.r_arm) {
    take(out, other, {Bone::r_clavicle, Bone::r_upper_arm, Bone::r_forearm, Bone::r_hand});
    out.r_grip = other.r_grip;
  }
  if (limbs.legs) {
    take(out, other, {Bone::pelvis, Bone::l_thigh, Bone::l_shin, Bone::l_foot});
    take(out, other, {Bone::r_thigh, Bone::r_shin, Bone::r_foot});
  }
  if (limbs.head) take(out, other, {Bone::neck, Bone::head});
  return out;
}

SampledPose draw_pose(std::span<const SampledPose> poses, float mixed, float mirrored_share, Random& random,
                      float touch_m) {
  if (poses.empty()) throw UsageError("draw_pose: expected at least one pose");
  const SampledPose& base = poses[random.below(static_cast<std::uint32_t>(poses.size()))];
  SampledPose drawn = random.uniform() < mixed ? draw_mixed(poses, base, touch_m, random) : base;
  drawn.pose.l_grip = float(random.uniform(0.0, 0.9));
  drawn.pose.r_grip = float(random.uniform(0.0, 0.9));
  if (random.uniform() < mirrored_share) drawn.pose = mirrored(drawn.pose);
  return drawn;
}

std::string posture_counts(std::span<const SampledPose> poses) {
  std::string text;
  for (const Posture posture : {Posture::standing, Posture::sitting, Posture::lying, Posture::kneeling}) {
    const auto count = std::ranges::count(poses, posture, &SampledPose::posture);
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", to_string(posture), count);
  }
  return text;
}

}  // namespace vesalius::synth
