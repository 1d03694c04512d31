#include "vesalius/known_people.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr int kWidth = 80, kHeight = 60;
constexpr float kFar = std::numeric_limits<float>::infinity();

Frame wall(std::uint16_t depth_mm) {
  Frame frame;
  frame.camera = {kWidth, kHeight, 80.F, 80.F, 39.5F, 29.5F};
  frame.depth = DepthImage(kWidth, kHeight, depth_mm);
  return frame;
}

/// Posteriors of one part and the background that give every pixel this probability of body.
Posteriors everywhere(double body) {
  Posteriors posteriors{kWidth, kHeight, 2, 255, {}};
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const auto part = static_cast<std::uint16_t>(std::lround(255.0 * body));
    posteriors.sums.push_back(part);
    posteriors.sums.push_back(static_cast<std::uint16_t>(255 - part));
  }
  return posteriors;
}

/// An upright limb two metres before the camera.
Capsule limb(float x) { return {{x, -0.3F, 2.F}, {x, 0.3F, 2.F}, 0.05F, 0.05F}; }

Prior::KnownPerson somebody(float x, float odds) { return {{}, {}, odds, {limb(x)}}; }

float x_of(const Frame& frame, int u) { return point_at(frame.camera, frame.depth, u, kHeight / 2).x(); }

const Mask kNothingFlat(kWidth, kHeight, 0);

TEST(KnownPeople, DistanceIsThatOfTheNearestCapsuleEverywhere) {
  Random random(5);
  const auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
  Frame frame = wall(0);
  for (std::uint16_t& depth : frame.depth) {
    depth =
        random.uniform(0.0, 1.0) < 0.1 ? std::uint16_t{0} : static_cast<std::uint16_t>(random.uniform(300.0, 3000.0));
  }
  for (int round = 0; round < 20; ++round) {
    std::vector<Capsule> capsules;
    for (int i = 0; i < 3; ++i) {
      // Some are partly behind the camera or out of view.
      const Eigen::Vector3f from(number(-1.5, 1.5), number(-1.0, 1.0), number(-0.3, 3.0));
      const Eigen::Vector3f to = from + Eigen::Vector3f(number(-0.5, 0.5), number(-0.5, 0.5), number(-0.5, 0.5));
      capsules.push_back({from, to, number(0.0, 0.3), number(0.0, 0.3)});
    }
    const Image<float> distance = distance_from(capsules, frame, 0.25F);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        float expected = kFar;
        for (const Capsule& capsule : capsules) {
          const float d = capsule.distance(point_at(frame.camera, frame.depth, u, v));
          if (frame.depth(u, v) != 0 && d < 0.25F) expected = std::min(expected, d);
        }
        ASSERT_EQ(distance(u, v), expected) << round << ": " << u << ' ' << v;
      }
    }
  }
}

TEST(SharedPixels, AreThoseOfBothAmongThoseOfEither) {
  Random random(6);
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{255, 1}, std::pair{128, 2}, std::pair{97, 60}}) {
    for (const std::uint32_t rare : {1U, 2U, 9U}) {  // 1: all are inside
      Mask a(width, height, 0), b(width, height, 0);
      float both = 0.F, either = 0.F;
      for (std::size_t i = 0; i < a.size(); ++i) {
        a[i] = random.below(rare) == 0 ? static_cast<std::uint8_t>(1 + random.below(2)) : std::uint8_t{0};
        b[i] = random.below(rare) == 0 ? std::uint8_t{1} : std::uint8_t{0};
        both += a[i] != 0 && b[i] != 0 ? 1.F : 0.F;
        either += a[i] != 0 || b[i] != 0 ? 1.F : 0.F;
      }
      EXPECT_EQ(shared_pixels(a, b), either > 0.F ? both / either : 0.F) << width << 'x' << height << ", " << rare;
    }
  }
}

TEST(KnownPeople, CapsulesThatAreNoNumbersAreNowhere) {
  const float nan = std::nanf("");
  for (const float value : {nan, kFar, -kFar}) {
    const Image<float> distance = distance_from({{{value, 0.F, 2.F}, {0.F, 0.F, 2.F}, 0.1F, 0.1F}}, wall(2000), 0.2F);
    EXPECT_TRUE(std::ranges::all_of(distance, [](float d) { return d == kFar; }));
  }
}

TEST(KnownPeople, TwoWhoTouchDivideThePixelsByNearness) {
  const Frame frame = wall(2000);
  const Posteriors posteriors = everywhere(0.9);
  Prior prior{{somebody(-0.1F, 2.F), somebody(0.1F, 2.F)}};
  const KnownPeople known(frame, kNothingFlat, posteriors, 1, prior);
  for (int u = 0; u < kWidth; ++u) {
    const float x = x_of(frame, u), left = std::abs(x + 0.1F) - 0.05F, right = std::abs(x - 0.1F) - 0.05F;
    const bool near = std::min(left, right) < kFleshReach_m;
    EXPECT_EQ(prior.people[0].mask(u, kHeight / 2) != 0, near && left < right) << u;
    EXPECT_EQ(prior.people[1].mask(u, kHeight / 2) != 0, near && right < left) << u;
  }
  // A mask over both becomes that of the one whom it is taken for.
  Mask both(kWidth, kHeight, 1);
  known.correct(0, true, both);
  EXPECT_EQ(both(20, 0), 1) << "far from both the forest is sure of a body";
  for (int u = 0; u < kWidth; ++u) EXPECT_EQ(both(u, kHeight / 2), prior.people[1].mask(u, kHeight / 2) == 0) << u;
}

TEST(KnownPeople, TheNearerAPixelTheLessTheForestMustSee) {
  const Frame frame = wall(2000);
  int before = kWidth;
  for (const double body : {0.8, 0.4, 0.2, 0.02}) {
    const Posteriors posteriors = everywhere(body);
    Prior prior{{somebody(0.F, 2.F)}};
    const KnownPeople known(frame, kNothingFlat, posteriors, 1, prior);
    int pixels = 0;
    for (int u = 0; u < kWidth; ++u) {
      if (prior.people[0].mask(u, kHeight / 2) == 0) continue;
      ++pixels;
      EXPECT_LT(std::abs(x_of(frame, u)), 0.05F + kFleshReach_m);
    }
    EXPECT_LT(pixels, before) << body;
    before = pixels;
  }
  EXPECT_EQ(before, 0) << "where the forest sees nobody flesh alone is not enough";
}

TEST(KnownPeople, FloorsAndHolesAreNobodys) {
  Frame frame = wall(2000);
  Mask flat = kNothingFlat;
  for (int v = 0; v < kHeight; ++v) {
    flat(38, v) = 1;
    frame.depth(41, v) = 0;
  }
  const Posteriors posteriors = everywhere(0.9);
  Prior prior{{somebody(0.F, 2.F)}};
  const KnownPeople known(frame, flat, posteriors, 1, prior);
  EXPECT_EQ(prior.people[0].mask(38, kHeight / 2), 0);
  EXPECT_EQ(prior.people[0].mask(41, kHeight / 2), 0);
  EXPECT_NE(prior.people[0].mask(40, kHeight / 2), 0);
}

TEST(KnownPeople, AGuessTakesNothingFromWhoIsSure) {
  const Frame frame = wall(2000);
  const Posteriors posteriors = everywhere(0.9);
  Prior prior{{somebody(0.F, 1.F), somebody(0.02F, 2.F)}};
  const KnownPeople known(frame, kNothingFlat, posteriors, 1, prior);
  EXPECT_EQ(prior.people[0].mask(39, kHeight / 2), 0);
  EXPECT_NE(prior.people[1].mask(39, kHeight / 2), 0);
  Mask mask(kWidth, kHeight, 1);
  known.correct(1, true, mask);
  EXPECT_EQ(mask(39, kHeight / 2), 1);
  known.correct(-1, true, mask);
  EXPECT_EQ(mask(39, kHeight / 2), 0) << "nobody else grows over who is sure";
}

TEST(KnownPeople, AMaskGainsWhatIsNearAndLosesWhatIsNeitherNearNorBody) {
  const Frame frame = wall(2000);
  const Posteriors posteriors = everywhere(0.45);
  Prior prior{{somebody(0.F, 2.F)}};
  const KnownPeople known(frame, kNothingFlat, posteriors, 1, prior);
  for (const bool at_flesh : {true, false}) {
    Mask mask(kWidth, kHeight, 0);
    mask(5, 5) = 1;
    known.correct(0, at_flesh, mask);
    EXPECT_EQ(mask(5, 5), at_flesh ? 0 : 1) << "who is elsewhere loses nothing";
    EXPECT_EQ(mask(39, kHeight / 2), 1);
  }
}

TEST(KnownPeople, AMaskShowsWhomItOverlapsMost) {
  const Frame frame = wall(2000);
  const Posteriors posteriors = everywhere(0.9);
  Prior prior{{somebody(-0.1F, 2.F), somebody(0.1F, 2.F)}};
  const KnownPeople known(frame, kNothingFlat, posteriors, 1, prior);
  EXPECT_EQ(known.shown_by(prior.people[0].mask), 0);
  EXPECT_EQ(known.shown_by(prior.people[1].mask), 1);
  EXPECT_EQ(known.shown_by(Mask(kWidth, kHeight, 0)), -1);
  Mask corner(kWidth, kHeight, 0);
  corner(0, 0) = 1;
  EXPECT_EQ(known.shown_by(corner), -1);
}

TEST(KnownPeople, WithoutFleshNothingChanges) {
  const Frame frame = wall(2000);
  const Posteriors posteriors = everywhere(0.1);
  Mask mask(kWidth, kHeight, 0);
  mask(3, 4) = 1;
  Prior prior{{{mask, {}, 2.F}}};
  const KnownPeople known(frame, kNothingFlat, posteriors, 1, prior);
  EXPECT_EQ(prior.people[0].mask, mask);
  Mask given(kWidth, kHeight, 1);
  known.correct(0, true, given);
  EXPECT_EQ(given, Mask(kWidth, kHeight, 1));
}

}  // namespace
}  // namespace vesalius
