#include "vesalius/forest/mean_kernel.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

struct Picture {
  DepthImage depth;
  Posteriors posteriors;
};

/// Returns a wall with a few steps and holes, so that windows of every kind occur, and posteriors up to the largest.
Picture random_picture(Random& random, int width, int height, int classes, int trees) {
  Picture p{DepthImage(width, height, 1500), {width, height, classes, trees, {}}};
  for (std::uint16_t& mm : p.depth) {
    const std::uint32_t kind = random.below(60);
    mm = kind == 0 ? 0 : static_cast<std::uint16_t>((kind == 1 ? 1800 : 1500) + random.below(kind == 2 ? 301 : 20));
  }
  const auto most = static_cast<std::uint32_t>(255 * trees);
  for (std::size_t i = 0; i < p.depth.size() * static_cast<std::size_t>(classes); ++i) {
    p.posteriors.sums.push_back(static_cast<std::uint16_t>(random.below(4) == 0 ? most : random.below(most + 1)));
  }
  return p;
}

std::vector<std::uint16_t> plain_means(const Picture& p, const SmoothWindow& window) {
  const int reach = window.each_way * window.spacing;
  std::vector<std::uint16_t> means(p.posteriors.sums.size(), 0);
  for (std::size_t i = 0; i < means.size(); ++i) {
    const int c = static_cast<int>(i % static_cast<std::size_t>(p.posteriors.classes));
    const int pixel = static_cast<int>(i) / p.posteriors.classes;
    const int u = pixel % p.depth.width(), v = pixel / p.depth.width();
    if (p.depth(u, v) == 0) continue;
    int sum = 0, count = 0;
    for (int nv = v - reach; nv <= v + reach; nv += window.spacing) {
      for (int nu = u - reach; nu <= u + reach; nu += window.spacing) {
        if (!p.depth.contains(nu, nv) || p.depth(nu, nv) == 0) continue;
        if (std::abs(p.depth(nu, nv) - p.depth(u, v)) > window.gate_mm) continue;
        sum += p.posteriors.at(nu, nv)[c];
        ++count;
      }
    }
    means[i] = static_cast<std::uint16_t>(sum / count);
  }
  return means;
}

/// Expects plain means on every instruction set, in ranges of rows with any end.
void expect_plain_means(const Picture& p, const SmoothWindow& window) {
  const std::vector<std::uint16_t> expected = plain_means(p, window);
  const int height = p.depth.height();
  for_each_target([&](const char* target) {
    Posteriors out = p.posteriors;
    mean_rows(p.posteriors, p.depth, window, 0, height / 2, out);
    mean_rows(p.posteriors, p.depth, window, height / 2, height, out);
    EXPECT_EQ(out.sums, expected) << target << ' ' << p.depth.width() << 'x' << height << ", " << window.each_way
                                  << " each way, spacing " << window.spacing << ", " << p.posteriors.classes
                                  << " classes";
  });
}

TEST(MeanKernel, AgreesWithThePlainMeanOnEveryInstructionSet) {
  Random random(31);
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{4, 9}, std::pair{9, 9}, std::pair{41, 23}}) {
    for (const int classes : {1, 5, 16, 26, 40}) {
      const Picture p = random_picture(random, width, height, classes, 10);
      for (const int each_way : {0, 1, 2}) {
        for (const int spacing : {1, 2, 3}) expect_plain_means(p, {each_way, spacing, 300});
      }
    }
  }
}

TEST(MeanKernel, KeepsSettledPixels) {
  Random random(33);
  Picture p = random_picture(random, 41, 23, 26, 10);
  p.posteriors.settled = Mask(41, 23, 0);
  for (std::uint8_t& settled : p.posteriors.settled) settled = random.below(3) == 0 ? 1 : 0;
  std::vector<std::uint16_t> expected = plain_means(p, {2, 2, 300});
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (p.posteriors.settled[i / 26] != 0) expected[i] = p.posteriors.sums[i];
  }
  for_each_target([&](const char* target) {
    Posteriors out = p.posteriors;
    mean_rows(p.posteriors, p.depth, {2, 2, 300}, 0, 23, out);
    EXPECT_EQ(out.sums, expected) << target;
  });
}

}  // namespace
}  // namespace vesalius
