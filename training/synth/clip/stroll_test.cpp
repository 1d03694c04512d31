#include "synth/clip/stroll.h"

#include <gtest/gtest.h>

#include <cmath>

#include "synth/pose/pose.h"
#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {
namespace {

/// Returns somebody who can walk, and stay in two ways.
Repertoire repertoire() {
  Random random(2);
  Repertoire can;
  can.gait = sample_gait(random);
  for (int i = 0; i < 2; ++i) {
    Movement stay;
    stay.fps = 1.F;
    stay.states.resize(2);
    stay.states[0].pose = stay.states[1].pose =
        sample_pose({.walking = 0.F, .sitting = 0.F, .lying = 0.F}, random).pose;
    stay.states[1].heading_rad = 0.2F;
    can.stays.push_back(stay);
  }
  return can;
}

TEST(Stroll, ReachesItsGoalAndStops) {
  const Repertoire can = repertoire();
  const Eigen::Vector2f goal(2.F, -1.F);
  StrollState state;
  bool there = false;
  for (int i = 0; i < 20 * 60 && !there; ++i) {
    advance(can, goal, state);
    there = (state.at - goal).norm() < 0.35F;
  }
  ASSERT_TRUE(there);
  for (int i = 0; i < 60; ++i) advance(can, std::nullopt, state);
  const Eigen::Vector2f stopped = state.at;
  for (int i = 0; i < 60; ++i) advance(can, std::nullopt, state);
  EXPECT_LT((state.at - stopped).norm(), 0.01F);
  EXPECT_LT((state.at - goal).norm(), 1.F);
}

TEST(Stroll, IsContinuousWhateverItDoes) {
  const Repertoire can = repertoire();
  StrollState state;
  TrackState before = shown(can, state);
  for (int i = 0; i < 900; ++i) {
    const bool walks = (i / 130) % 2 == 1;
    advance(can, walks ? std::optional(Eigen::Vector2f(3.F, (i / 260) % 2 == 1 ? 5.F : -5.F)) : std::nullopt, state);
    const TrackState now = shown(can, state);
    EXPECT_LT((now.at - before.at).norm() * kTrackRate_hz, 4.F) << i;
    EXPECT_LT(std::abs(now.heading_rad - before.heading_rad) * kTrackRate_hz, 3.5F) << i;
    EXPECT_LT(largest_angle(now.pose, before.pose) * kTrackRate_hz, 14.F) << i;
    before = now;
  }
}

/// Feet slide where a way turns; planted they slide less, and the way stays about the same.
TEST(PlantFeet, LetsFeetSlideLess) {
  Repertoire can = repertoire();
  Random random(0);
  can.gait = sample_gait(random);  // a fast one
  const float leg_m = bone_length_m(Bone::l_thigh) + bone_length_m(Bone::l_shin);
  can.leg_m = leg_m;
  PersonTrack slides;
  StrollState state;
  for (int i = 0; i < 480; ++i) {
    advance(can, Eigen::Vector2f(state.at + 2.F * left_of(state.heading_rad)), state);
    slides.states.push_back(shown(can, state));
  }
  PersonTrack planted = slides;
  plant_feet(leg_m, planted);
  const auto slid_m = [](const PersonTrack& track) {
    float sum_m = 0.F;
    for (std::size_t i = 120; i < track.states.size(); ++i) {
      float least_m = 1.F;
      for (const Bone foot : {Bone::l_foot, Bone::r_foot}) {
        for (const bool tail : {false, true}) {
          const auto at = [&](const TrackState& s) {
            const StickFigure figure = stick_figure(s.pose);
            const Eigen::Vector3f p = Eigen::AngleAxisf(s.heading_rad, Eigen::Vector3f::UnitY()) *
                                      (tail ? figure.tail_of(foot) : figure.head_of(foot));
            return Eigen::Vector2f(s.at + Eigen::Vector2f(p.x(), p.z()));
          };
          least_m = std::min(least_m, (at(track.states[i]) - at(track.states[i - 1])).norm());
        }
      }
      sum_m += least_m;
    }
    return sum_m;
  };
  EXPECT_LT(slid_m(planted), 0.6F * slid_m(slides));
  for (std::size_t i = 0; i < slides.states.size(); ++i) {
    EXPECT_LT((planted.states[i].at - slides.states[i].at).norm(), 0.16F);
  }
}

}  // namespace
}  // namespace vesalius::synth
