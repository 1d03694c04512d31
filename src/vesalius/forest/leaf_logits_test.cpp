#include "vesalius/forest/leaf_logits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

/// Computes the shares from all pairs of a part and a heading.
std::vector<double> plain_shares(const LogitLayout& layout, const std::vector<float>& logits) {
  const int headings = std::max(layout.headings, 1);
  std::vector<double> shares(layout.size(), 0.0);
  double all = layout.background ? std::exp(static_cast<double>(logits[layout.parts])) : 0.0;
  if (layout.background) shares[layout.parts] = all;
  for (int p = 0; p < layout.parts; ++p) {
    for (int h = 0; h < headings; ++h) {
      double logit = static_cast<double>(logits[p]);
      if (layout.headings > 0) logit += static_cast<double>(logits[layout.turn(layout.side[p], h)]);
      shares[p] += std::exp(logit);
      if (layout.headings > 0) shares[layout.turn(layout.side[p], h)] += std::exp(logit);
      all += std::exp(logit);
    }
  }
  for (double& share : shares) share /= all;
  return shares;
}

std::vector<float> random_logits(Random& random, const LogitSoftmax& softmax, double bound) {
  std::vector<float> logits(softmax.padded(), 0.F);
  for (int i = 0; i < softmax.layout().size(); ++i) logits[i] = static_cast<float>(random.uniform(-bound, bound));
  return logits;
}

TEST(LogitLayout, KnowsTheSidesOfParts) {
  const LogitLayout layout(paper_body(), true, 8);
  EXPECT_EQ(layout.size(), 26 + 24);
  EXPECT_EQ(layout.side[paper_body().find_part("neck")], 0);
  EXPECT_EQ(layout.side[paper_body().find_part("l_knee")], 1);
  EXPECT_EQ(layout.side[paper_body().find_part("r_knee")], 2);
  EXPECT_EQ(layout.turn(2, 7), layout.size() - 1);
}

TEST(LogitSoftmax, IsTheSoftmaxOverPartsAndHeadings) {
  Random random(3, 0);
  for (const int headings : {0, 1, 8}) {
    for (const bool background : {false, true}) {
      const LogitSoftmax softmax(LogitLayout(paper_body(), background, headings));
      for (const double bound : {0.1, 3.0, 20.0}) {
        const std::vector<float> logits = random_logits(random, softmax, bound);
        const std::vector<double> expected = plain_shares(softmax.layout(), logits);
        for_each_target([&](const char* target) {
          std::vector<float> shares = logits;
          softmax(shares.data());
          for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_NEAR(shares[i], expected[i], 1e-5) << target << ", place " << i << " of bound " << bound;
          }
        });
      }
    }
  }
}

TEST(LogitSoftmax, GivesTheSameBitsOnEveryInstructionSet) {
  Random random(4, 0);
  const LogitSoftmax softmax(LogitLayout(paper_body(), true, 8));
  for (int i = 0; i < 50; ++i) {
    const std::vector<float> logits = random_logits(random, softmax, 8.0);
    std::vector<float> first;
    for_each_target([&](const char* target) {
      std::vector<float> shares = logits;
      softmax(shares.data());
      if (first.empty()) first = shares;
      EXPECT_EQ(shares, first) << target;
    });
  }
}

TEST(LogitSoftmax, BearsLogitsOfAnySize) {
  const LogitSoftmax softmax(LogitLayout(paper_body(), true, 8));
  for (const float background : {-1e4F, 1e4F}) {
    std::vector<float> values(softmax.padded(), 0.F);
    values[25] = background;
    values[3] = 500.F;
    values[7] = -500.F;
    softmax(values.data());
    for (const float share : values) {
      EXPECT_GE(share, 0.F);
      EXPECT_LE(share, 1.0001F);
    }
    EXPECT_NEAR(values[background > 0.F ? 25 : 3], 1.F, 1e-4F);
  }
}

TEST(LogitReader, SumsLeaves) {
  const LogitLayout layout(paper_body(), true, 8);
  const float unit = 0.05F;
  LogitReader reader(layout, unit, 3);
  const LogitSoftmax softmax(layout);
  Random random(5, 0);
  for (int round = 0; round < 20; ++round) {
    std::vector<float> sums(softmax.padded(), 0.F);
    std::array<std::vector<std::int8_t>, 3> leaves;
    for (std::vector<std::int8_t>& leaf : leaves) {
      leaf.resize(reader.padded(), 0);
      for (int i = 0; i < layout.size(); ++i) {
        leaf[i] = static_cast<std::int8_t>(static_cast<int>(random.below(256)) - 128);
        sums[i] += static_cast<float>(leaf[i]) * unit;
      }
    }
    softmax(sums.data());
    std::vector<std::uint16_t> posteriors(26), turns(24);
    reader.read(std::array<const std::int8_t*, 3>{leaves[0].data(), leaves[1].data(), leaves[2].data()}.data(),
                posteriors.data(), turns.data());
    double body = 0.0;
    for (int i = 0; i < 24; ++i) body += static_cast<double>(sums[26 + i]);
    for (int c = 0; c < 26; ++c) EXPECT_NEAR(posteriors[c], 765.F * sums[c], 1.F);
    for (int i = 0; i < 24 && body > 1e-3; ++i) {
      EXPECT_NEAR(turns[i], 65535.0 * static_cast<double>(sums[26 + i]) / body, 2.0);
    }
  }
}

}  // namespace
}  // namespace vesalius
