#include "vesalius/forest/person_points.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace vesalius {
namespace {

constexpr int kWidth = 40, kHeight = 30, kParts = 4, kClasses = 5;
const Camera kCamera{kWidth, kHeight, 50.F, 60.F, 19.5F, 14.5F};

/// A person of two parts: a large one above, and five pixels of another below.
struct Labelled {
  DepthImage depth{kWidth, kHeight, 2000};
  LabelImage labels{kWidth, kHeight, kBackground};
  Box of{4, 2, 30, 26};  // where posteriors are known
  Box box{6, 5, 20, 20};
  Posteriors posteriors;

  Labelled() : posteriors{.width = of.width, .height = of.height, .classes = kClasses, .whole = 255, .sums = {}} {
    for (int v = 5; v < 20; ++v) {
      for (int u = 6; u < 26; ++u) labels(u, v) = 0;
    }
    for (int u = 10; u < 15; ++u) labels(u, 24) = 3;
    posteriors.sums.assign(static_cast<std::size_t>(of.width) * of.height * kClasses, 0);
  }
  void vote(int u, int v, const std::array<std::uint16_t, kClasses>& sums) {
    std::ranges::copy(sums, posteriors.at(u - of.u, v - of.v));
  }
  std::vector<PersonPoint> sample() const { return sample_points(depth, kCamera, labels, box, posteriors, of, kParts); }
};

/// Returns the pixel of a point.
std::pair<int, int> pixel_of(const PersonPoint& point) {
  const Eigen::Vector2f pixel = kCamera.pixel(point.at);
  return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
}

TEST(PersonPoints, AreSpreadEvenlyOverEachPart) {
  const Labelled labelled;
  std::vector<int> places;  // of the large part, in the order of its 300 pixels
  int small = 0;
  for (const PersonPoint& point : labelled.sample()) {
    const auto [u, v] = pixel_of(point);
    EXPECT_EQ(point.part.front(), labelled.labels(u, v));
    if (v == 24) ++small;
    if (v < 24) places.push_back((v - 5) * 20 + u - 6);
  }
  EXPECT_EQ(small, 5) << "all of a part that has fewer";
  ASSERT_EQ(places.size(), static_cast<std::size_t>(kPointsOfPart));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const int before = i == 0 ? -1 : places[i - 1];
    EXPECT_NEAR(places[i] - before, 300.0 / kPointsOfPart, 1.0);
  }
}

TEST(PersonPoints, LieWhereTheCameraSeesThem) {
  Labelled labelled;
  for (int u = 10; u < 15; ++u) labelled.depth(u, 24) = static_cast<std::uint16_t>(1500 + u);
  for (const PersonPoint& point : labelled.sample()) {
    const auto [u, v] = pixel_of(point);
    const float z_m = static_cast<float>(labelled.depth(u, v)) * 1e-3F;
    EXPECT_LT((point.at - kCamera.point(static_cast<float>(u), static_cast<float>(v), z_m)).norm(), 1e-5F);
  }
}

TEST(PersonPoints, LeaveHolesAndTheRestOut) {
  Labelled labelled;
  labelled.depth(10, 24) = 0;
  labelled.depth(12, 24) = 0;
  labelled.labels(11, 24) = kParts;  // the class after the parts
  int small = 0;
  for (const PersonPoint& point : labelled.sample()) {
    const auto [u, v] = pixel_of(point);
    if (v == 24) ++small;
    EXPECT_GT(point.at.z(), 0.F);
  }
  EXPECT_EQ(small, 2);
  labelled.depth.fill(0);
  EXPECT_TRUE(labelled.sample().empty());
}

TEST(PersonPoints, KnowTheLikeliestParts) {
  Labelled labelled;
  labelled.vote(10, 24, {10, 50, 30, 10, 100});  // the background's share does not count
  labelled.vote(11, 24, {0, 0, 0, 200, 0});
  labelled.vote(12, 24, {0, 60, 0, 180, 0});
  // Of the others nothing is known: the label stands.
  for (const PersonPoint& point : labelled.sample()) {
    const auto [u, v] = pixel_of(point);
    if (v != 24) continue;
    SCOPED_TRACE(u);
    std::array<int, 3> parts{3, kBackground, kBackground};
    std::array<float, 3> shares{1.F, 0.F, 0.F};
    if (u == 10) {
      parts = {1, 2, 0};
      shares = {0.5F, 0.3F, 0.1F};
    } else if (u == 12) {
      parts = {3, 1, kBackground};
      shares = {0.75F, 0.25F, 0.F};
    }
    for (int i = 0; i < PersonPoint::kParts; ++i) {
      EXPECT_EQ(point.part[i], parts[i]) << i;
      EXPECT_FLOAT_EQ(point.share[i], shares[i]) << i;
    }
    EXPECT_TRUE(std::ranges::is_sorted(point.share, std::greater<>()));
  }
}

}  // namespace
}  // namespace vesalius
