#include "vesalius/forest/smooth_labels.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "vesalius/base/random.h"
#include "vesalius/base/test_threads.h"

namespace vesalius {
namespace {

/// At this focal length, neighbours are adjacent pixels.
constexpr Camera kSmallCamera{37, 23, 40.F, 40.F, 18.F, 11.F};

struct Picture {
  LabelImage labels{37, 23};
  DepthImage depth{37, 23};
};

Picture random_picture(std::uint64_t seed) {
  Random random(seed);
  Picture p;
  for (auto& l : p.labels) l = random.below(5) == 0 ? kBackground : static_cast<std::uint8_t>(random.below(4));
  for (auto& z : p.depth) z = random.below(6) == 0 ? 0 : static_cast<std::uint16_t>(1000 + random.below(700));
  return p;
}

/// Returns patches of one label with few speckles, so that some windows have one label and some nearly do.
Picture patchy_picture(std::uint64_t seed) {
  Random random(seed, 1);
  Picture p = random_picture(seed);
  for (int v = 0; v < p.labels.height(); ++v) {
    for (int u = 0; u < p.labels.width(); ++u) {
      const bool speckle = random.below(60) == 0;
      p.labels(u, v) = static_cast<std::uint8_t>(speckle ? random.below(4) : (u / 13 + v / 11) % 2);
    }
  }
  return p;
}

template <class Use>
void neighbours(const DepthImage& depth, int u, int v, int window, int spacing, int gate_mm, Use use) {
  for (int j = -window / 2; j <= window / 2; ++j) {
    for (int i = -window / 2; i <= window / 2; ++i) {
      const int nu = u + i * spacing, nv = v + j * spacing;
      if (!depth.contains(nu, nv) || depth(nu, nv) == 0) continue;
      if (std::abs(depth(nu, nv) - depth(u, v)) <= gate_mm) use(nu, nv);
    }
  }
}

std::uint8_t slow_mode(const Picture& p, int u, int v, const SmoothOptions& o) {
  if (p.depth(u, v) == 0) return kBackground;
  std::map<std::uint8_t, int> count;
  neighbours(p.depth, u, v, o.window, 1, kModeDepthGate_mm, [&](int nu, int nv) { ++count[p.labels(nu, nv)]; });
  int most = 0;
  for (const auto& [label, n] : count) most = std::max(most, n);
  if (count[p.labels(u, v)] == most) return p.labels(u, v);
  for (const auto& [label, n] : count) {
    if (n == most) return label;  // lowest first
  }
  return kBackground;
}

class Windows : public testing::TestWithParam<int> {};

TEST_P(Windows, GiveTheModeThatCountingGives) {
  const SmoothOptions options{.window = GetParam()};
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Picture p = seed < 3 ? random_picture(seed) : patchy_picture(seed);
    const LabelImage fast = mode_filter(p.labels, p.depth, options);
    for (int v = 0; v < p.depth.height(); ++v) {
      for (int u = 0; u < p.depth.width(); ++u) {
        ASSERT_EQ(int{fast(u, v)}, int{slow_mode(p, u, v, options)}) << "seed " << seed << " at " << u << ' ' << v;
      }
    }
  }
}

void expect_plain_mean(const SmoothOptions& options) {
  const Picture p = random_picture(9);
  Posteriors in{37, 23, 6, 3 * 255, {}};
  Random random(1);
  for (std::size_t i = 0; i < p.depth.size() * 6; ++i) {
    in.sums.push_back(p.depth[i / 6] == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(random.below(766)));
  }
  const Posteriors out = mean_filter(in, p.depth, kSmallCamera, options);
  EXPECT_EQ(out.whole, 3 * 255);
  for (int v = 0; v < p.depth.height(); ++v) {
    for (int u = 0; u < p.depth.width(); ++u) {
      for (int c = 0; c < 6; ++c) {
        int sum = 0, n = 0;
        if (p.depth(u, v) != 0) {
          neighbours(p.depth, u, v, options.window, std::max(1, options.spacing), options.depth_gate_mm,
                     [&](int nu, int nv) {
                       sum += in.at(nu, nv)[c];
                       ++n;
                     });
        }
        ASSERT_EQ(out.at(u, v)[c], n > 0 ? sum / n : 0)
            << u << ' ' << v << " class " << c << " spacing " << options.spacing;
      }
    }
  }
}

TEST_P(Windows, GiveTheMeanThatSummingGives) {
  for (const int spacing : {0, 1, 2, 3}) {
    expect_plain_mean({.window = GetParam(), .spacing = spacing, .depth_gate_mm = 250});
  }
}

TEST(MeanFilter, KeepsSettledPixels) {
  const DepthImage depth(9, 9, 1000);
  Posteriors in{9, 9, 6, 255, std::vector<std::uint16_t>(9 * 9 * 6, 0)};
  in.settled = Mask(9, 9, 0);
  in.settled(4, 4) = 1;
  in.at(4, 4)[5] = in.at(1, 4)[5] = 250;
  const Posteriors out = mean_filter(in, depth, kSmallCamera, {.spacing = 1});
  EXPECT_EQ(out.settled, in.settled);
  EXPECT_EQ(out.at(4, 4)[5], 250);
  EXPECT_EQ(out.at(1, 4)[5], 250 / 20) << "a window of 5 cut by the border";
  EXPECT_EQ(out.at(5, 4)[5], 10) << "counts for its neighbours";
}

TEST(MeanFilter, LosesTheLowestBitsIfSumsExceed16Bits) {
  const Picture p = random_picture(9);
  for (const auto& [trees, lost] : {std::pair{10, 0}, std::pair{11, 1}, std::pair{20, 1}, std::pair{40, 2}}) {
    const int bits = lost;
    Posteriors in{37, 23, 26, 255 * trees, {}};
    in.settled = Mask(37, 23, 0);
    Random random(2);
    for (std::size_t i = 0; i < p.depth.size() * 26; ++i) {
      in.sums.push_back(p.depth[i / 26] == 0 ? std::uint16_t{0}
                                             : static_cast<std::uint16_t>(random.below(255U * trees + 1U)));
    }
    in.settled(4, 4) = 1;
    const SmoothOptions options{.window = 5, .spacing = 1, .depth_gate_mm = 250};
    const Posteriors out = mean_filter(in, p.depth, kSmallCamera, options);
    for (int v = 0; v < 23; ++v) {
      for (int u = 0; u < 37; ++u) {
        int sum = 0, n = 0;
        if (p.depth(u, v) != 0) {
          neighbours(p.depth, u, v, options.window, 1, options.depth_gate_mm, [&](int nu, int nv) {
            sum += in.at(nu, nv)[7] >> bits;
            ++n;
          });
        }
        const int mean = n > 0 ? (sum / n) << bits : 0;
        ASSERT_EQ(out.at(u, v)[7], in.settled(u, v) != 0 ? in.at(u, v)[7] : mean)
            << trees << " trees at " << u << ' ' << v;
      }
    }
  }
}

TEST(MeanFilter, SpacesNeighboursByTheFocalLength) {
  const auto spacing = [](float fx, int given) {
    return spaced({.spacing = given}, Camera{320, 240, fx, fx, 159.5F, 119.5F}).spacing;
  };
  EXPECT_EQ(spacing(525.F, 0), 4);
  EXPECT_EQ(spacing(262.5F, 0), 2);
  EXPECT_EQ(spacing(131.F, 0), 1);
  EXPECT_EQ(spacing(20.F, 0), 1);
  EXPECT_EQ(spacing(525.F, 3), 3) << "as asked for";
}

INSTANTIATE_TEST_SUITE_P(Sizes, Windows, testing::Values(1, 3, 4, 5, 9));

TEST(ModeFilter, RemovesASpeckleButNotAcrossADepthStep) {
  LabelImage labels(7, 7, 3);
  DepthImage depth(7, 7, 1500);
  labels(3, 3) = 8;
  EXPECT_EQ(mode_filter(labels, depth, {})(3, 3), 3);
  depth(3, 3) = 1900;  // 400 mm behind, so no neighbour is within the gate
  EXPECT_EQ(mode_filter(labels, depth, {})(3, 3), 8);
}

// Labels: threads
TEST(ModeFilter, GivesTheSameBytesForAnyNumberOfThreads) {
  const Picture p = random_picture(4);
  std::vector<LabelImage> results;
  for_threads({1, 2, 8}, [&] { results.push_back(mode_filter(p.labels, p.depth, {})); });
  EXPECT_THAT(results, testing::Each(results[0]));
}

}  // namespace
}  // namespace vesalius
