#include "vesalius/vote_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr int kSide = 96;
constexpr int kCells = kSide / kPartVoteStep;

/// A wall 2 m away, somebody's all of it, whose pixels vote for two parts.
struct Voting {
  Frame frame = depth_frame(DepthImage(kSide, kSide, 2000), {kSide, kSide, 100.F, 100.F, 48.F, 48.F});
  Mask person = Mask(kSide, kSide, 1);
  PartVotes votes{
      .width = kCells, .height = kCells, .parts = 2, .ways_mm = std::vector<std::int16_t>(kCells * kCells * 6)};

  Vector3f point(int column, int row) const {
    return point_at(frame.camera, frame.depth, column * kPartVoteStep, row * kPartVoteStep);
  }
  void vote(int column, int row, int part, const Vector3f& centre) {
    const Vector3f way = 1e3F * (centre - point(column, row));
    std::int16_t* to = votes.ways_mm.data() + ((row * kCells + column) * 2 + part) * 3;
    for (int axis = 0; axis < 3; ++axis) to[axis] = std::int16_t(std::lround(way[axis]));
  }
  template <class Centre>
  void vote_everywhere(const Centre& centre) {
    for (int row = 0; row < kCells; ++row) {
      for (int column = 0; column < kCells; ++column) {
        for (int part = 0; part < 2; ++part) vote(column, row, part, centre(column, row, part));
      }
    }
  }
  std::vector<VotedPart> parts() const { return vote_parts(votes, frame, person); }
};

const Vector3f kSeen(0.1F, 0.2F, 2.05F), kHidden(-0.3F, 0.1F, 2.5F);

Vector3f truth(int part) { return part == 0 ? kSeen : kHidden; }

TEST(VoteParts, FindsWhereAllVotesMeet) {
  Voting of;
  of.vote_everywhere([](int, int, int part) { return truth(part); });
  const std::vector<VotedPart> parts = of.parts();
  ASSERT_EQ(parts.size(), 2U);
  for (int part = 0; part < 2; ++part) {
    EXPECT_LT((parts[part].centre - truth(part)).norm(), 0.001F);
    EXPECT_LT(parts[part].spread_m, 0.001F);
  }
}

TEST(VoteParts, SaysHowFarVotesDiffer) {
  Voting of;
  Random random(3);
  of.vote_everywhere([&](int, int, int part) {
    const float off = (part == 0 ? 0.01F : 0.1F) * float(random.normal());
    return Vector3f(truth(part) + Vector3f(0.F, off, 0.F));
  });
  const std::vector<VotedPart> parts = of.parts();
  EXPECT_NEAR(parts[0].spread_m, 0.0067F, 0.005F);  // the median of what a Gaussian is off
  EXPECT_NEAR(parts[1].spread_m, 0.067F, 0.05F);
  EXPECT_LT((parts[1].centre - kHidden).norm(), 0.1F);
}

TEST(VoteParts, BelievesThoseThatAreNearest) {
  Voting of;
  of.vote_everywhere([&](int column, int row, int part) {
    const bool near = (of.point(column, row) - truth(part)).norm() < 0.65F;
    return near ? truth(part) : Vector3f(truth(part) + Vector3f(0.F, 1.F, 3.F));
  });
  for (int part = 0; part < 2; ++part) EXPECT_LT((of.parts()[part].centre - truth(part)).norm(), 0.001F) << part;
}

TEST(VoteParts, AsksThePersonsPixelsWithReadingsAlone) {
  Voting of;
  of.vote_everywhere([](int column, int, int part) {
    return Vector3f(truth(part) + Vector3f(column < kCells / 2 ? 0.F : 1.F, 0.F, 0.F));
  });
  for (int v = 0; v < kSide; ++v) {
    for (int u = kSide / 2; u < kSide; ++u) of.person(u, v) = 0;
  }
  EXPECT_LT((of.parts()[1].centre - kHidden).norm(), 0.001F);
  EXPECT_LT(of.parts()[1].spread_m, 0.001F);
  of.person = Mask(kSide, kSide, 1);
  for (int v = 0; v < kSide; ++v) {
    for (int u = kSide / 2; u < kSide; ++u) of.frame.depth(u, v) = 0;
  }
  EXPECT_LT((of.parts()[1].centre - kHidden).norm(), 0.001F);
}

TEST(VoteParts, NeedsVotesOfSomePixels) {
  Voting of;
  of.vote_everywhere([](int, int, int part) { return truth(part); });
  of.person.fill(0);
  for (int i = 0; i < kLeastPartVotes; ++i) {
    EXPECT_TRUE(of.parts().empty());
    of.person(i * kPartVoteStep, 0) = 1;
  }
  EXPECT_EQ(of.parts().size(), 2U);
  of.votes = {};
  EXPECT_TRUE(of.parts().empty());
}

TEST(VoteParts, IsTheMedianOfTheNearestEighth) {
  Voting of;
  Random random(4);
  of.vote_everywhere([&](int, int, int) {
    const auto draw = [&] { return float(random.normal(0.0, 0.3)); };
    const float x = draw(), y = draw();
    return Vector3f(x, y, 2.F + draw());
  });
  for (int part = 0; part < 2; ++part) {
    std::vector<std::pair<float, Vector3f>> all;
    for (int row = 0; row < kCells; ++row) {
      for (int column = 0; column < kCells; ++column) {
        const std::int16_t* way = of.votes.at(column, row) + 3 * part;
        const Vector3f ways = Vector3f(way[0], way[1], way[2]);
        all.emplace_back(ways.squaredNorm(), of.point(column, row) + 1e-3F * ways);
      }
    }
    std::ranges::stable_sort(all, {}, &std::pair<float, Vector3f>::first);
    all.resize(all.size() / 8);
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<float> values;
      for (const auto& one : all) values.push_back(one.second[axis]);
      std::ranges::sort(values);
      EXPECT_FLOAT_EQ(of.parts()[part].centre[axis], values[values.size() / 2]);
    }
  }
}

}  // namespace
}  // namespace vesalius
