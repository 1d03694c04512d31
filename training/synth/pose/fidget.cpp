#include "synth/pose/fidget.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "synth/pose/mix_poses.h"
#include "synth/pose/self_contact.h"

namespace vesalius::synth {
namespace {

constexpr float kFps = 30.F;
constexpr float kMeanSpeed_rad_s = 1.7F;  ///< the fastest moment of a move has half as much more

float between(float low, float high, Random& random) { return float(random.uniform(low, high)); }

float smooth(float share) { return share * share * (3.F - 2.F * share); }

Pose draw_other(const Pose& base, std::span<const Pose> others, Random& random) {
  if (others.empty()) return base;
  const Pose& other = others[random.below(static_cast<std::uint32_t>(others.size()))];
  const std::uint32_t bits = 1 + random.below(7);
  const Pose mixed = mix_limbs(
      base, other, {.l_arm = (bits & 1U) != 0, .r_arm = (bits & 2U) != 0, .legs = false, .head = (bits & 4U) != 0});
  return intersects_itself(mixed) ? base : mixed;
}

/// Returns whether arms that turn the shorter way pass through the body.
bool passes_through(const Pose& from, const Pose& to) {
  return std::ranges::any_of(std::array{0.25F, 0.5F, 0.75F},
                             [&](float share) { return intersects_itself(interpolated(from, to, share)); });
}

}  // namespace

Movement fidget(const Pose& base, std::span<const Pose> others, float seconds, Random& random) {
  Movement movement;
  movement.name = "fidget";
  movement.fps = kFps;
  const auto count = static_cast<std::size_t>(std::ceil(seconds * kFps)) + 1;
  Pose from = base;
  while (movement.states.size() < count) {
    const auto rest = int(between(0.3F, 2.F, random) * kFps);
    for (int i = 0; i < rest; ++i) movement.states.push_back({from, 0.F, Eigen::Vector2f::Zero()});
    const Pose to = draw_other(base, others, random);
    if (passes_through(from, to)) continue;
    const float least_s = largest_angle(from, to) / kMeanSpeed_rad_s;
    const int steps = int(std::max(0.4F, least_s * between(1.F, 1.6F, random)) * kFps);
    for (int i = 1; i <= steps; ++i) {
      const float share = smooth(float(i) / float(steps));
      movement.states.push_back({interpolated(from, to, share), 0.F, Eigen::Vector2f::Zero()});
    }
    from = to;
  }
  movement.states.resize(count);
  return movement;
}

}  // namespace vesalius::synth
