#include "vesalius/network/posterior_kernels.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

using testing::ElementsAre;

constexpr int kWhole = 2040;

/// Fewer classes than the lanes of a vector, as many, more, and those of the paper's body.
constexpr std::array kClasses{2, 3, 4, 7, 8, 9, 15, 16, 17, 25, 26, 32, 33, 40};

/// Logits of `pixels` pixels: any, or mostly far below the background's.
std::vector<std::int16_t> random_logits(Random& random, int pixels, int classes) {
  std::vector<std::int16_t> logits(std::size_t(pixels) * std::size_t(classes));
  for (std::size_t i = 0; i < logits.size(); ++i) {
    const bool background = int(i) % classes == classes - 1;
    const bool sure = int(i) / classes % 3 == 0;
    logits[i] = static_cast<std::int16_t>(int(random.below(4000)) - 2000 + (background && sure ? 3500 : 0));
  }
  return logits;
}

TEST(SoftmaxInSteps, IsThatOfRealNumbersRounded) {
  Random random(3, 0);
  constexpr int kPixels = 60;
  for (const int classes : kClasses) {
    const std::vector<std::int16_t> logits = random_logits(random, kPixels, classes);
    const double most_off = 0.51 + classes * kWhole * std::exp(-10.0);  // what is less than that counts as nothing
    for_each_target([&](const char* target) {
      std::vector<std::uint16_t> shares(logits.size(), 9);
      softmax_in_steps(logits.data(), kPixels, classes, kWhole, shares.data());
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const std::size_t first = i / std::size_t(classes) * std::size_t(classes);
        double sum = 0.0;
        for (std::size_t c = 0; c < std::size_t(classes); ++c) sum += std::exp(double(logits[first + c]) / 256.0);
        ASSERT_NEAR(shares[i], kWhole * std::exp(double(logits[i]) / 256.0) / sum, most_off)
            << target << ' ' << classes << " classes, number " << i;
      }
    });
  }
}

TEST(SoftmaxInSteps, IsTheSameForEveryInstructionSet) {
  Random random(4, 0);
  constexpr int kPixels = 200;
  for (const int classes : kClasses) {
    const std::vector<std::int16_t> logits = random_logits(random, kPixels, classes);
    std::vector<std::uint16_t> expected;
    for_each_target([&](const char* target) {
      std::vector<std::uint16_t> shares(logits.size());
      softmax_in_steps(logits.data(), kPixels, classes, kWhole, shares.data());
      if (expected.empty()) expected = shares;
      EXPECT_EQ(shares, expected) << target << ' ' << classes << " classes";
    });
  }
}

TEST(SoftmaxInSteps, BearsTheLargestDifferences) {
  const std::array<std::int16_t, 3> logits{-32768, 32767, 32767};
  std::array<std::uint16_t, 3> shares;
  softmax_in_steps(logits.data(), 1, 3, kWhole, shares.data());
  EXPECT_THAT(shares, ElementsAre(0, 1020, 1020));
  const std::array<std::int16_t, 3> certain{-32768, -32768, 32767};
  softmax_in_steps(certain.data(), 1, 3, kWhole, shares.data());
  EXPECT_THAT(shares, ElementsAre(0, 0, kWhole));
}

/// What enlarge_row says, for one pixel.
std::vector<std::uint16_t> plainly_enlarged(const DepthImage& depth, const Posteriors& half, int u, int v) {
  struct Neighbour {
    const std::uint16_t* sums;
    bool settled;
    int off_mm;
  };
  const int mm = depth(u, v);
  std::vector<Neighbour> around;
  for (int hv = v / 2; hv <= std::min((v + 1) / 2, half.height - 1); ++hv) {
    for (int hu = u / 2; hu <= std::min((u + 1) / 2, half.width - 1); ++hu) {
      const int there_mm = depth(2 * hu, 2 * hv);
      around.push_back({half.at(hu, hv), half.settled(hu, hv) != 0, there_mm == 0 ? 1 << 16 : std::abs(there_mm - mm)});
    }
  }
  std::vector<Neighbour> of;
  for (const Neighbour& each : around) {
    if (each.off_mm < 20 + 3 * mm / 100) of.push_back(each);
  }
  if (of.size() < 2) of = {*std::ranges::min_element(around, {}, &Neighbour::off_mm)};
  if (std::ranges::all_of(around, &Neighbour::settled) || (u % 2 == 0 && v % 2 == 0)) of = {around.front()};
  std::vector<std::uint16_t> mean(std::size_t(half.classes), 0);
  for (std::size_t c = 0; mm != 0 && c < mean.size(); ++c) {
    std::size_t sum = 0;
    for (const Neighbour& each : of) sum += each.sums[c];
    mean[c] = static_cast<std::uint16_t>(sum / of.size());
  }
  return mean;
}

TEST(EnlargeRow, TakesFromThePixelsAroundOnEveryInstructionSet) {
  Random random(5, 0);
  for (const int classes : kClasses) {
    for (const auto& size : {std::array{1, 1}, {2, 3}, {33, 5}, {40, 8}}) {
      const int width = size[0], height = size[1];
      DepthImage depth(width, height, 0);
      for (std::uint16_t& mm : depth) {
        if (random.below(6) != 0) mm = static_cast<std::uint16_t>(1500 + random.below(2) * 2000 + random.below(90));
      }
      Posteriors half;
      half.settled = Mask((width + 1) / 2, (height + 1) / 2, 0);
      half.resize_like({.width = half.settled.width(),
                        .height = half.settled.height(),
                        .classes = classes,
                        .whole = kWhole,
                        .sums = {},
                        .settled = half.settled});
      for (std::uint16_t& sum : half.sums) sum = static_cast<std::uint16_t>(random.below(kWhole + 1));
      for (std::uint8_t& settled : half.settled) settled = random.below(4) != 0 ? 1 : 0;
      for_each_target([&](const char* target) {
        Posteriors out;
        out.resize_like({.width = width, .height = height, .classes = classes, .whole = kWhole, .sums = {}});
        for (int v = 0; v < height; ++v) enlarge_row(depth, half, v, out);
        for (int v = 0; v < height; ++v) {
          for (int u = 0; u < width; ++u) {
            ASSERT_EQ(std::vector(out.at(u, v), out.at(u, v) + classes), plainly_enlarged(depth, half, u, v))
                << target << ' ' << classes << " classes, " << u << ',' << v;
          }
        }
      });
    }
  }
}

}  // namespace
}  // namespace vesalius
