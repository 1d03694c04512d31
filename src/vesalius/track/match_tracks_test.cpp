#include "vesalius/track/match_tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using testing::ElementsAre;

constexpr float kNever = std::numeric_limits<float>::infinity();

float cost_of(const Eigen::MatrixXf& costs, float unmatched, const std::vector<int>& match) {
  float sum = 0.F;
  for (int row = 0; row < costs.rows(); ++row) sum += match[row] < 0 ? unmatched : costs(row, match[row]);
  return sum;
}

/// Tries all.
float least_cost(const Eigen::MatrixXf& costs, float unmatched, int row, std::vector<bool>& taken) {
  if (row == costs.rows()) return 0.F;
  float least = unmatched + least_cost(costs, unmatched, row + 1, taken);
  for (int column = 0; column < costs.cols(); ++column) {
    if (taken[column] || !(costs(row, column) < unmatched)) continue;
    taken[column] = true;
    least = std::min(least, costs(row, column) + least_cost(costs, unmatched, row + 1, taken));
    taken[column] = false;
  }
  return least;
}

TEST(MatchTracks, TakesTheBestForAllAndNotForEach) {
  Eigen::MatrixXf costs(2, 2);
  costs << 1.F, 2.F, 1.5F, 9.F;
  EXPECT_THAT(match_tracks(costs, 10.F), ElementsAre(1, 0));
}

TEST(MatchTracks, LeavesOutWhomNobodyFits) {
  Eigen::MatrixXf costs(3, 2);
  costs << 1.F, kNever, 0.5F, kNever, kNever, std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(match_tracks(costs, 4.F), ElementsAre(-1, 0, -1));
  EXPECT_THAT(match_tracks(Eigen::MatrixXf(2, 0), 1.F), ElementsAre(-1, -1));
  EXPECT_TRUE(match_tracks(Eigen::MatrixXf(0, 3), 1.F).empty());
}

TEST(MatchTracks, IsAsGoodAsTryingAll) {
  Random random(3);
  for (int round = 0; round < 500; ++round) {
    const int rows = static_cast<int>(random.below(6)), columns = static_cast<int>(random.below(6));
    Eigen::MatrixXf costs(rows, columns);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        // Few values, so that many are equal, and negative ones.
        costs(row, column) = random.below(5) == 0 ? kNever : static_cast<float>(random.below(12)) - 3.F;
      }
    }
    const std::vector<int> match = match_tracks(costs, 6.F);
    std::vector<bool> taken(columns, false);
    for (const int column : match) {
      if (column < 0) continue;
      EXPECT_FALSE(taken[column]) << "twice";
      taken[column] = true;
    }
    std::vector<bool> free(columns, false);
    EXPECT_FLOAT_EQ(cost_of(costs, 6.F, match), least_cost(costs, 6.F, 0, free)) << costs;
  }
}

TEST(MatchTracks, FindsAHiddenPermutationOfAHundred) {
  Random random(4);
  constexpr int kPeople = 100;
  std::vector<int> permutation(kPeople);
  for (int i = 0; i < kPeople; ++i) permutation[i] = i;
  for (int i = kPeople - 1; i > 0; --i) {
    std::swap(permutation[i], permutation[random.below(static_cast<std::uint32_t>(i + 1))]);
  }
  Eigen::MatrixXf costs(kPeople, kPeople);
  for (int row = 0; row < kPeople; ++row) {
    for (int column = 0; column < kPeople; ++column) {
      costs(row, column) = static_cast<float>(random.uniform(column == permutation[row] ? 0.0 : 1.0, 2.0)) -
                           (column == permutation[row] ? 1.5F : 0.F);
    }
  }
  EXPECT_EQ(match_tracks(costs, 50.F), permutation);
}

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
