#include "synth/clip/tracks.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace vesalius::synth {
namespace {

/// Returns somebody who walks to and fro 3 m before the camera.
PersonTrack walker(float seconds) {
  PersonTrack track;
  for (int i = 0; i < track_length(seconds); ++i) {
    TrackState state;
    state.at = {1.5F * std::sin(0.03F * static_cast<float>(i)), -3.F};
    track.states.push_back(state);
  }
  return track;
}

TEST(CameraMotion, KeepsItsSpeedsAndPlace) {
  const ClipOptions options;
  const CameraPose base{1.2F, 0.2F, 0.F};
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    Random random(seed);
    const CameraTrack track = move_camera(options, base, 8.F, {walker(8.F)}, random);
    float fastest_m_s = 0.F, fastest_deg_s = 0.F;
    for (std::size_t i = 1; i < track.poses.size(); ++i) {
      const Eigen::Isometry3f &a = track.poses[i - 1], &b = track.poses[i];
      fastest_m_s = std::max(fastest_m_s, (b.translation() - a.translation()).norm() * kTrackRate_hz);
      const Eigen::AngleAxisf turn(Eigen::Matrix3f(a.linear().transpose() * b.linear()));
      fastest_deg_s = std::max(fastest_deg_s, turn.angle() * kTrackRate_hz * 57.3F);
      const Eigen::Vector3f from = b.translation() - Eigen::Vector3f(0.F, base.height_m, 0.F);
      EXPECT_LT(from.norm(), kCameraReach_m + 0.1F);
    }
    EXPECT_GT(fastest_m_s, 0.01F);
    EXPECT_LE(fastest_m_s, options.speed_max_m_s);
    EXPECT_GT(fastest_deg_s, 1.F);
    EXPECT_LE(fastest_deg_s, options.turn_max_deg_s + 1.F);
  }
}

TEST(CameraMotion, KeepsPeopleInView) {
  Random random(1);
  PersonTrack aside = walker(8.F);
  for (TrackState& state : aside.states) state.at = {1.2F, -3.F};
  const CameraTrack track = move_camera({}, {1.2F, 0.F, 0.F}, 8.F, {aside}, random);
  const auto off = [&](float time_s) {
    const Eigen::Vector3f p = track.at(time_s).inverse() * Eigen::Vector3f(1.2F, 1.F, -3.F);
    return std::abs(std::atan2(p.x(), p.z()));
  };
  EXPECT_LT(off(8.F), 0.6F * off(0.F));
}

TEST(CameraMotion, GoesEvenlyBetweenItsPoses) {
  CameraTrack track;
  track.poses.assign(2, Eigen::Isometry3f::Identity());
  track.poses[1].translation().x() = 1.F;
  EXPECT_NEAR(track.at(0.5F / kTrackRate_hz).translation().x(), 0.5F, 1e-5F);
  EXPECT_EQ(track.at(9.F).translation().x(), 1.F);
}

}  // namespace
}  // namespace vesalius::synth
