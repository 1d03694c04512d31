#include "metrics/track_metrics.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <utility>

#include "metrics/test_terms.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using test::value_of;
using testing::ElementsAre;

constexpr int kTrueIds = 4;
constexpr int kFoundIds = 6;

/// Returns the sequence that tests/tracks/reference.py makes of the same seed. Each true id has a found one most like
/// it, another one every 20 frames.
std::vector<TrackSample> random_sequence(std::uint64_t seed) {
  Random random(seed, 7);
  std::vector<TrackSample> sequence;
  for (int frame = 0; frame < 60; ++frame) {
    TrackSample& sample = sequence.emplace_back();
    for (int id = 0; id < kTrueIds; ++id) {
      if (random.uniform() < 0.8) sample.truth.push_back(id);
    }
    for (int id = 0; id < kFoundIds; ++id) {
      if (random.uniform() < 0.7) sample.found.push_back(id);
    }
    sample.similarity.resize(static_cast<Eigen::Index>(sample.truth.size()),
                             static_cast<Eigen::Index>(sample.found.size()));
    for (Eigen::Index t = 0; t < sample.similarity.rows(); ++t) {
      for (Eigen::Index f = 0; f < sample.similarity.cols(); ++f) {
        const bool own = sample.found[f] == (sample.truth[t] + frame / 20) % kFoundIds;
        sample.similarity(t, f) = own ? 0.4 + 0.6 * random.uniform() : 0.6 * random.uniform();
      }
    }
  }
  return sequence;
}

MetricTerms all_terms(const std::vector<TrackSample>& sequence) {
  MetricTerms all;
  for (const MetricTerms& terms : track_terms(sequence)) all.insert(all.end(), terms.begin(), terms.end());
  return all;
}

/// Returns a sequence of one true person, who is found under each of these ids or missed (0).
std::vector<TrackSample> found_as(const std::vector<int>& ids) {
  std::vector<TrackSample> sequence;
  for (const int id : ids) {
    TrackSample sample{{7}, {}, Eigen::MatrixXd(1, 0)};
    if (id > 0) sample = {{7}, {id}, Eigen::MatrixXd::Constant(1, 1, 0.8)};
    sequence.push_back(sample);
  }
  return sequence;
}

TEST(TrackMetrics, AreThoseOfOtherPrograms) {
  // Of motmetrics: MOTA, missed, false, switches, IDF1. Rows: the sequences of seeds 0, 1, 2 and all of them.
  // tests/tracks/reference.py prints and checks the table.
  constexpr std::array<std::array<double, 5>, 4> kExpected{{
      {-0.143617021277, 51, 121, 43, 0.27802690583},
      {-0.273224043716, 55, 131, 47, 0.27149321267},
      {-0.106060606061, 64, 101, 54, 0.290993071594},
      {-0.17223198594, 170, 353, 144, 0.280090840273},
  }};
  MetricTable all;
  const auto check = [](const MetricTable& table, const std::array<double, 5>& expected) {
    const std::vector<Estimate> estimates = table.estimates();
    const auto value = [&](Metric metric) { return find_estimate(estimates, metric)->value; };
    const auto numerator = [&](Metric metric) { return find_estimate(estimates, metric)->numerator; };
    const std::array found{value(Metric::track_mota), numerator(Metric::track_missed), numerator(Metric::track_false),
                           numerator(Metric::track_switches), value(Metric::track_idf1)};
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9) << "column " << i;
  };
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const MetricTerms terms = all_terms(random_sequence(seed));
    MetricTable alone;
    alone.add(seed, terms);
    all.add(seed, terms);
    check(alone, kExpected[seed]);
  }
  check(all, kExpected[3]);
}

TEST(TrackMetrics, ArePerfectForTheTruth) {
  std::vector<TrackSample> sequence;
  for (int frame = 0; frame < 5; ++frame) {
    sequence.push_back({{1, 2}, {20, 10}, (Eigen::MatrixXd(2, 2) << 0, 1, 1, 0).finished()});
  }
  MetricTable table;
  table.add(1, all_terms(sequence));
  for (const Estimate& e : table.estimates()) {
    const bool counts_faults = info(e.id.metric).direction == MetricDirection::lower_is_better;
    EXPECT_DOUBLE_EQ(e.value, counts_faults && e.id.metric != Metric::track_ids ? 0.0 : 1.0) << e.id.name();
  }
}

TEST(TrackMetrics, CountIdsAndSwitchesOfEachPerson) {
  const MetricTerms terms = all_terms(found_as({0, 3, 3, 0, 0, 0, 3, 4, 0, 4}));
  EXPECT_DOUBLE_EQ(value_of(terms, "track.missed"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "track.ids"), 2.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "track.switches"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "track.mota"), 0.4);
  EXPECT_DOUBLE_EQ(value_of(terms, "track.idf1"), 2.0 * 3.0 / 15.0);
}

TEST(TrackMetrics, CountPeopleInEmptyFramesAsFalse) {
  const std::vector<TrackSample> sequence{{{}, {5}, Eigen::MatrixXd(0, 1)}, {{}, {}, Eigen::MatrixXd(0, 0)}};
  MetricTable table;
  table.add(1, all_terms(sequence));
  const std::vector<Estimate> estimates = table.estimates();
  EXPECT_DOUBLE_EQ(find_estimate(estimates, Metric::track_false)->value, 0.5);
  EXPECT_EQ(find_estimate(estimates, Metric::track_mota), nullptr);
  EXPECT_TRUE(track_terms({}).empty());
}

TEST(TrackMatcher, StaysWithTheLastId) {
  TrackMatcher matcher;
  EXPECT_THAT(matcher.match({{1}, {5}, Eigen::MatrixXd::Constant(1, 1, 0.9)}), ElementsAre(0));
  EXPECT_THAT(matcher.match({{1}, {6}, Eigen::MatrixXd::Constant(1, 1, 0.4)}), ElementsAre(-1));
  EXPECT_THAT(matcher.match({{1}, {4, 5}, (Eigen::MatrixXd(1, 2) << 0.9, 0.6).finished()}), ElementsAre(1));
  EXPECT_THAT(matcher.match({{1}, {4, 5}, (Eigen::MatrixXd(1, 2) << 0.9, 0.3).finished()}), ElementsAre(0));
}

TEST(TrackMatcher, PairsAsManyAsItCan) {
  // The most similar pair alone would leave the second true person without one.
  TrackMatcher matcher;
  const Eigen::MatrixXd similarity = (Eigen::MatrixXd(2, 2) << 0.99, 0.5, 0.51, 0.0).finished();
  EXPECT_THAT(matcher.match({{1, 2}, {8, 9}, similarity}), ElementsAre(1, 0));
}

TEST(TrackMatcher, RefusesWhatIsNoSimilarity) {
  TrackMatcher matcher;
  EXPECT_THROW(matcher.match({{1}, {2}, Eigen::MatrixXd(1, 2)}), Error);
  for (const double wrong : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(matcher.match({{1}, {2}, Eigen::MatrixXd::Constant(1, 1, wrong)}), Error) << wrong;
  }
}

}  // namespace
}  // namespace vesalius
