#include "vesalius/track/match_cost.h"

#include <gtest/gtest.h>

#include "vesalius/track/match_tracks.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

/// Returns somebody found there, without a mask, whose links are `size` times the usual ones.
Sighting sighting_at(float x, float size) {
  Sighting sighting;
  sighting.trunk = {{x, 0.F, 3.F}, 0.05F};
  sighting.person.score = 0.95F;
  sighting.scale = size;
  return sighting;
}

/// Returns who was followed to x = 0 at a steady speed, of whom too little was seen at once to measure links.
Track walked_to_middle(int id, float speed_m_s) {
  constexpr double kFrame_s = 1.0 / 30.0;
  const auto at = [&](int frame) {
    Sighting sighting = sighting_at(speed_m_s * static_cast<float>((frame - 30) * kFrame_s), 1.F);
    sighting.scale.reset();
    return sighting;
  };
  Track track(id, at(0), 0.0);
  for (int frame = 1; frame <= 30; ++frame) {
    track.motion.predict(kFrame_s);
    track.take_sighting(at(frame), frame * kFrame_s);
  }
  track.motion.predict(0.4);  // both are hidden behind something
  return track;
}

TEST(MatchCost, AChildAndAnAdultWhoLookTheSameKeepTheirIdsWhereTheyCross) {
  std::vector<Track> tracks{walked_to_middle(1, 0.8F), walked_to_middle(2, -0.8F)};
  // They turned round where nobody saw it: each comes out where the other was expected.
  const std::vector<Sighting> sightings{sighting_at(-0.15F, 0.97F), sighting_at(0.15F, 0.66F)};
  const auto matched = [&] {
    Eigen::MatrixXf costs(2, 2);
    for (int t = 0; t < 2; ++t) {
      for (int s = 0; s < 2; ++s) {
        costs(t, s) =
            match_cost(tracks[static_cast<std::size_t>(t)], sightings[static_cast<std::size_t>(s)], nullptr, 1.4, 0.1F);
      }
    }
    return match_tracks(costs, kMostMatchCost);
  };
  EXPECT_EQ(matched(), (std::vector{1, 0})) << "places alone mistake them";
  tracks[0].size.fit(1.02F);
  tracks[1].size.fit(0.7F);
  EXPECT_EQ(matched(), (std::vector{0, 1}));
}

}  // namespace
}  // namespace vesalius
