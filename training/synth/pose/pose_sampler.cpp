#include "synth/pose/pose_sampler.h"

#include <fmt/format.h>

#include <array>
#include <initializer_list>
#include <optional>

#include "synth/pose/judge_pose.h"
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
  Pose (*draw)(Random&);
  std::optional<Posture> posture;  ///< empty if it follows from the pose
  const char* help;
};

using P = Posture;
using O = PoseSamplerOptions;
constexpr std::array<Kind, 16> kKinds{{
    {"idle", &O::idle, kinds::idle, P::standing, "Weight of people who stand about."},
    {"walking", &O::walking, kinds::walking, P::standing, "Weight of people who walk."},
    {"reaching", &O::reaching, kinds::reaching, P::standing, "Weight of people who reach for something or point."},
    {"waving", &O::waving, kinds::waving, P::standing, "Weight of people who wave."},
    {"bending", &O::bending, kinds::bending, P::standing, "Weight of people who bend down."},
    {"arms-crossed", &O::arms_crossed, kinds::arms_crossed, P::standing, "Weight of people with crossed arms."},
    {"arms-behind", &O::arms_behind, kinds::arms_behind, P::standing, "Weight of people with their hands behind them."},
    {"hands-on-hips", &O::hands_on_hips, kinds::hands_on_hips, P::standing, "Weight of people with hands on hips."},
    {"carrying", &O::carrying, kinds::carrying, P::standing, "Weight of people who carry something."},
    {"phone", &O::phone, kinds::phone, P::standing, "Weight of people with a telephone at the ear or in the hand."},
    {"sitting", &O::sitting, kinds::sitting, P::sitting, "Weight of people who sit on chairs and sofas."},
    {"floor-sitting", &O::floor_sitting, kinds::floor_sitting, P::sitting, "Weight of people who sit on the floor."},
    {"lying", &O::lying, kinds::lying, P::lying, "Weight of people who lie on back, side or front."},
    {"kneeling", &O::kneeling, kinds::kneeling, P::kneeling, "Weight of people on one knee, both, or all fours."},
    {"squatting", &O::squatting, kinds::squatting, P::standing, "Weight of people who squat."},
    {"any", &O::any, kinds::any, std::nullopt, "Weight of joints drawn uniformly from all that they can do."},
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

bool possible(const Pose& pose) {
  return arm_in_range(arm_angles(pose, true)) && arm_in_range(arm_angles(pose, false)) && !intersects_itself(pose);
}

void take(Pose& pose, const Pose& other, std::initializer_list<Bone> bones) {
  for (const Bone bone : bones) pose[bone] = other[bone];
}

Limbs draw_limbs(Random& random) {
  const std::uint32_t bits = 1 + random.below(15);
  return {(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0};
}

SampledPose draw_mixed(std::span<const SampledPose> poses, const SampledPose& base, Random& random) {
  constexpr int kMixes = 20;
  for (int i = 0; i < kMixes; ++i) {
    const SampledPose& other = poses[random.below(static_cast<std::uint32_t>(poses.size()))];
    const Limbs limbs = draw_limbs(random);
    if (other.posture != base.posture) continue;
    const Pose mixed = mix_limbs(base.pose, other.pose, limbs);
    if (!intersects_itself(mixed) && classify_posture(mixed) == base.posture) return {mixed, base.posture};
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

SampledPose sample_pose(const PoseSamplerOptions& options, Random& random) {
  const Kind& kind = draw_kind(options, random);
  for (int i = 0; i < kTries; ++i) {
    const Pose pose = kind.draw(random);
    if (!possible(pose)) continue;
    const Posture posture = classify_posture(pose);
    if (!kind.posture || posture == *kind.posture) return {pose, posture};
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

SampledPose draw_pose(std::span<const SampledPose> poses, float mixed, float mirrored_share, Random& random) {
  if (poses.empty()) throw UsageError("draw_pose: expected at least one pose");
  const SampledPose& base = poses[random.below(static_cast<std::uint32_t>(poses.size()))];
  SampledPose drawn = random.uniform() < mixed ? draw_mixed(poses, base, random) : base;
  drawn.pose.l_grip = float(random.uniform(0.0, 0.9));
  drawn.pose.r_grip = float(random.uniform(0.0, 0.9));
  if (random.uniform() < mirrored_share) drawn.pose = mirrored(drawn.pose);
  return drawn;
}

}  // namespace vesalius::synth
