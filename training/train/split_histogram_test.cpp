#include "train/split_histogram.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

constexpr int kClasses = 7;

/// Rows with their own memory.
struct Rows {
  std::vector<std::int16_t> values;
  std::vector<std::uint8_t> labels;
  int width;

  FeatureRows view() const { return {values.data(), labels.data(), labels.size(), width}; }
  int value(std::size_t row, int candidate) const { return values[row * width + candidate]; }
};

/// Returns random rows. Every candidate has a spread of its own, from none to all of int16, and labels depend on some
/// of the values.
Rows random_rows(std::size_t count, int width, Random& random) {
  Rows rows{{}, {}, width};
  for (std::size_t r = 0; r < count; ++r) {
    const auto label = static_cast<std::uint8_t>(random.below(kClasses - 1) + (random.below(3) == 0 ? 1 : 0));
    rows.labels.push_back(label);
    for (int c = 0; c < width; ++c) {
      const double spread = std::pow(2.0, c % 16);
      const double value = random.normal(c % 3 == 0 ? 0.3 * label * spread : 0.0, spread);
      rows.values.push_back(static_cast<std::int16_t>(std::clamp(value, -32768.0, 32767.0)));
    }
  }
  return rows;
}

/// Returns the task that counts the rows of one shard.
CountTask task_of(const Rows& rows, int bins) {
  const NodeValues values = node_values(rows.view(), kClasses + 1);
  return {{values.ranges, bins}, ClassIndex(values.class_counts)};
}

double entropy_bits(const std::vector<int>& counts) {
  double total = 0.0, sum = 0.0;
  for (const int n : counts) total += n;
  for (const int n : counts) sum -= n > 0 ? n / total * std::log2(n / total) : 0.0;
  return sum;
}

/// Returns the information gained by a threshold, from the definition.
double gain_of(const Rows& rows, int candidate, int threshold) {
  std::vector<int> left(kClasses + 1, 0), right(kClasses + 1, 0), all(kClasses + 1, 0);
  for (std::size_t r = 0; r < rows.labels.size(); ++r) {
    ++(rows.value(r, candidate) <= threshold ? left : right)[rows.labels[r]];
    ++all[rows.labels[r]];
  }
  const auto n = static_cast<double>(rows.labels.size());
  double nl = 0.0;
  for (const int count : left) nl += count;
  return entropy_bits(all) - nl / n * (nl > 0 ? entropy_bits(left) : 0.0) -
         (n - nl) / n * (nl < n ? entropy_bits(right) : 0.0);
}

int count_left(const Rows& rows, int candidate, int threshold) {
  int n = 0;
  for (std::size_t r = 0; r < rows.labels.size(); ++r) n += rows.value(r, candidate) <= threshold ? 1 : 0;
  return n;
}

TEST(EntropyTable, IsNLogN) {
  const EntropyTable entropy;
  EXPECT_EQ(entropy(0), 0);
  EXPECT_EQ(entropy(1), 0);
  EXPECT_EQ(entropy(2), 2048);
  EXPECT_EQ(entropy(1024), 1024 * 10 * 1024);
  EXPECT_GT(entropy(kMostCounted), 0) << "fits";
}

TEST(Binning, HasTheLastValueOfABinAsItsThreshold) {
  Random random(1);
  for (const int bins : {2, 8, 16, 32}) {
    const Rows rows = random_rows(300, 32, random);
    const Binning binning = task_of(rows, bins).binning;
    for (int c = 0; c < rows.width; ++c) {
      for (std::size_t r = 0; r < rows.labels.size(); ++r) {
        const int bin = binning.bin_of(c, rows.value(r, c));
        ASSERT_LT(bin, bins);
        ASSERT_LE(rows.value(r, c), binning.last_value(c, bin)) << bins << ' ' << c;
        if (bin > 0) {
          ASSERT_GT(rows.value(r, c), binning.last_value(c, bin - 1)) << bins << ' ' << c;
        }
      }
    }
  }
}

TEST(Binning, GivesEachOfFewValuesABin) {
  Rows rows{{}, {0, 0, 1, 1}, 16};
  for (const std::int16_t value : std::array<std::int16_t, 4>{-1, 0, 1, 1})
    rows.values.insert(rows.values.end(), 16, value);
  const Binning binning = task_of(rows, 32).binning;
  EXPECT_EQ(binning.bin_of(3, -1), 0);
  EXPECT_EQ(binning.bin_of(3, 0), 1);
  EXPECT_EQ(binning.bin_of(3, 1), 2);
}

TEST(SplitHistogram, CountsEveryRowOnceInItsBinOnEveryInstructionSet) {
  Random random(2);
  const Rows rows = random_rows(500, 48, random);
  for_each_target([&](const char* target) {
    const auto [binning, classes] = task_of(rows, 16);
    const SplitHistogram histogram = count_bins(rows.view(), {binning, classes});
    std::vector<std::uint16_t> truth(histogram.counts.size(), 0);
    for (std::size_t r = 0; r < rows.labels.size(); ++r) {
      for (int c = 0; c < rows.width; ++c) {
        const int row = classes.index[rows.labels[r]] * binning.bins + binning.bin_of(c, rows.value(r, c));
        ++truth[row * kBlockCandidates + c];
      }
    }
    EXPECT_EQ(histogram.counts, truth) << target;
  });
}

/// Returns the best of all thresholds between bins of all candidates, in order, from the definition with the same
/// integers.
BinSplit obvious_split(const Rows& rows, const Binning& binning, int candidates, int least,
                       const EntropyTable& entropy) {
  BinSplit best{-1, 0, std::numeric_limits<std::int32_t>::min()};
  for (int c = 0; c < candidates; ++c) {
    for (int b = 0; b + 1 < binning.bins; ++b) {
      std::vector<int> left(kClasses + 1, 0), right(kClasses + 1, 0);
      int n_left = 0, n_right = 0;
      for (std::size_t r = 0; r < rows.labels.size(); ++r) {
        const bool goes_left = binning.bin_of(c, rows.value(r, c)) <= b;
        ++(goes_left ? left : right)[rows.labels[r]];
        ++(goes_left ? n_left : n_right);
      }
      if (std::min(n_left, n_right) < least) continue;
      std::int32_t score = -entropy(n_left) - entropy(n_right);
      for (int k = 0; k <= kClasses; ++k) {
        score += entropy(left[k]) + entropy(right[k]);
      }
      if (score > best.score) best = {c, b, score};
    }
  }
  return best;
}

TEST(BestSplit, AgreesWithTryingEveryThresholdOnEveryInstructionSet) {
  const EntropyTable entropy;
  Random random(4);
  for_each_target([&](const char* target) {
    for (const auto& [count, candidates, bins, least] :
         {std::array{400, 60, 32, 1}, std::array{90, 17, 8, 30}, std::array{50, 64, 16, 26}}) {
      const Rows rows = random_rows(count, (candidates + 15) / 16 * 16, random);
      const auto [binning, classes] = task_of(rows, bins);
      const SplitHistogram histogram = count_bins(rows.view(), {binning, classes});
      const BinSplit truth = obvious_split(rows, binning, candidates, least, entropy);
      const BinSplit found = best_split(histogram, candidates, classes, least, entropy);
      EXPECT_EQ(found.candidate, truth.candidate) << target;
      if (truth.candidate < 0) continue;
      EXPECT_EQ(found.bin, truth.bin);
      EXPECT_EQ(found.score, truth.score);
    }
  });
}

TEST(RefineSplit, FindsTheBestThresholdOfBothBins) {
  const EntropyTable entropy;
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const Rows rows = random_rows(200, 16, random);
    const auto [binning, classes] = task_of(rows, 8);
    const SplitHistogram histogram = count_bins(rows.view(), {binning, classes});
    const BinChoice choice = choose_bin(histogram, 16, classes, 10, entropy);
    const BinSplit& split = choice.split;
    ASSERT_GE(split.candidate, 0);
    const ThresholdSplit refined =
        refine_split(values_in(rows.view(), beside(split, binning, 0)), choice, classes, 10, entropy);
    EXPECT_NEAR(refined.gain, gain_of(rows, split.candidate, refined.threshold_mm), 1e-3);
    double best = 0.0;
    const int low = split.bin > 0 ? binning.last_value(split.candidate, split.bin - 1) : -32768;
    for (int t = low; t < binning.last_value(split.candidate, split.bin + 1); ++t) {
      const int left = count_left(rows, split.candidate, t);
      if (left >= 10 && 200 - left >= 10) best = std::max(best, gain_of(rows, split.candidate, t));
    }
    EXPECT_NEAR(refined.gain, best, 1e-3);
    EXPECT_GE(refined.gain, gain_of(rows, split.candidate, binning.last_value(split.candidate, split.bin)) - 1e-3);
  }
}

TEST(RefineSplit, LiesMidwayBetweenValuesAndKeepsASingleBinEdge) {
  const EntropyTable entropy;
  Rows rows{{}, {0, 0, 1, 1}, 16};
  for (const std::int16_t value : std::array<std::int16_t, 4>{-100, -90, 300, 301})
    rows.values.insert(rows.values.end(), 16, value);
  const auto [binning, classes] = task_of(rows, 8);
  const SplitHistogram histogram = count_bins(rows.view(), {binning, classes});
  const BinChoice choice = choose_bin(histogram, 16, classes, 1, entropy);
  EXPECT_EQ(choice.split.candidate, 0);
  const ThresholdSplit refined =
      refine_split(values_in(rows.view(), beside(choice.split, binning, 0)), choice, classes, 1, entropy);
  EXPECT_NEAR(refined.gain, 1.0, 1e-3);
  EXPECT_GE(refined.threshold_mm, -90);
  EXPECT_LT(refined.threshold_mm, 300);
}

}  // namespace
}  // namespace vesalius
