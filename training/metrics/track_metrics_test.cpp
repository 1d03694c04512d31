#include "metrics/track_metrics.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <utility>

#include "metrics/match_people.h"
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
  // Of motmetrics: MOTA, missed, false, switches, IDF1; of trackeval: HOTA. Rows: the sequences of seeds 0, 1, 2 and
  // all of them. tests/tracks/reference.py prints and checks the table.
  constexpr std::array<std::array<double, 6>, 4> kExpected{{
      {-0.143617021277, 51, 121, 43, 0.27802690583, 0.212829909636},
      {-0.273224043716, 55, 131, 47, 0.27149321267, 0.194974231278},
      {-0.106060606061, 64, 101, 54, 0.290993071594, 0.214622557803},
      {-0.17223198594, 170, 353, 144, 0.280090840273, 0.20774585111},
  }};
  MetricTable all;
  const auto check = [](const MetricTable& table, const std::array<double, 6>& expected) {
    const std::vector<Estimate> estimates = table.estimates();
    const auto value = [&](Metric metric) { return find_estimate(estimates, metric)->value; };
    const auto numerator = [&](Metric metric) { return find_estimate(estimates, metric)->numerator; };
    const std::array found{value(Metric::track_mota),      numerator(Metric::track_missed),
                           numerator(Metric::track_false), numerator(Metric::track_switches),
                           value(Metric::track_idf1),      value(Metric::track_hota)};
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
  EXPECT_DOUBLE_EQ(find_estimate(estimates, Metric::track_hota)->value, 0.0);
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

using testing::IsEmpty;

constexpr int kSize = 40;

/// Returns a mask of some columns.
Mask columns(int from, int to) {
  Mask mask(kSize, kSize, 0);
  for (int v = 0; v < kSize; ++v) std::fill(mask.row(v) + from, mask.row(v) + to, std::uint8_t{1});
  return mask;
}

TrackedPerson found(int id, Mask mask, const Eigen::Vector3f& position = Eigen::Vector3f::Zero()) {
  TrackedPerson person;
  person.id = id;
  person.state = mask.empty() ? TrackState::hidden : TrackState::tracked;
  person.person.mask = std::move(mask);
  person.position = position;
  return person;
}

TrueFrame empty_frame() {
  TrueFrame frame;
  frame.frame.camera = {kSize, kSize, 40.F, 40.F, 19.5F, 19.5F};  // 25 cm^2 a pixel at 2 m
  frame.frame.depth = DepthImage(kSize, kSize, 2000);
  return frame;
}

/// Returns a frame of person 4 in the columns 0 to 19 and person 9 in so many columns after these, whose trunks lie at
/// x = -0.5 and 0.5 m.
TrueFrame two_people(int second_columns) {
  TrueFrame frame = empty_frame();
  FrameTruth& truth = frame.truth;
  truth.people = 2;
  truth.person = Image<std::uint8_t>(kSize, kSize, kBackground);
  for (int v = 0; v < kSize; ++v) {
    std::fill_n(truth.person.row(v), 20, std::uint8_t{0});
    std::fill_n(truth.person.row(v) + 20, second_columns, std::uint8_t{1});
  }
  truth.joint_names = {"head", "l_hip", "r_hip"};
  truth.joints = {{{9, 9, 9}, {-0.4F, 0, 2}, {-0.6F, 0, 2}}, {{9, 9, 9}, {0.6F, 0, 2}, {0.4F, 0, 2}}};
  truth.ids = {4, 9};
  put_visible_people_first(frame);
  return frame;
}

TEST(TrackSample, HasTheIouOfMasks) {
  const TrackedFrame tracked{0.0, {found(1, columns(20, 40)), found(2, columns(5, 20))}, {}, {}};
  const auto people = track_people_of(two_people(20), tracked, false);
  ASSERT_TRUE(people);
  EXPECT_THAT(people->sample.truth, ElementsAre(4, 9));
  EXPECT_THAT(people->sample.found, ElementsAre(1, 2));
  EXPECT_TRUE(people->sample.similarity.isApprox((Eigen::MatrixXd(2, 2) << 0, 0.75, 1, 0).finished()));
}

TEST(TrackSample, LeavesOutPeopleOfWhomTooLittleIsVisible) {
  TrueFrame frame = two_people(0);
  for (int u = 20; u < 30; ++u) frame.truth.person(u, 0) = 1;  // 250 cm^2
  put_visible_people_first(frame);
  Mask sliver(kSize, kSize, 0);
  std::fill_n(sliver.row(0) + 20, 10, std::uint8_t{1});
  const TrackedFrame tracked{0.0, {found(1, columns(0, 20)), found(2, sliver), found(3, {})}, {}, {}};
  const auto people = track_people_of(frame, tracked, false);
  EXPECT_THAT(people->sample.truth, ElementsAre(4));
  EXPECT_THAT(people->sample.found, ElementsAre(1));
}

TEST(TrackSample, ComparesHiddenPeopleByTheirTrunksIfAsked) {
  TrackedFrame tracked{0.0, {found(1, columns(0, 20)), found(3, {}, {0.5F, 0.3F, 2})}, {}, {}};
  auto people = track_people_of(two_people(0), tracked, true);
  EXPECT_THAT(people->sample.truth, ElementsAre(4, 9));
  EXPECT_THAT(people->sample.found, ElementsAre(1, 3));
  EXPECT_NEAR(people->sample.similarity(1, 1), 0.7, 1e-6);
  EXPECT_EQ(people->sample.similarity(0, 0), 1.0);
  tracked.people[1].state = TrackState::lost;
  people = track_people_of(two_people(0), tracked, true);
  EXPECT_THAT(people->sample.found, ElementsAre(1));
}

TEST(TrackSample, ComparesTrunksWhereOnlyJointsAreKnown) {
  TrueFrame frame = empty_frame();
  frame.truth.people = 1;
  frame.truth.joint_names = {"l_hip", "r_hip"};
  frame.truth.joints = {{{-0.1F, 0, 2}, {0.1F, 0, 2}}};
  frame.truth.ids = {0};
  const TrackedFrame tracked{0.0, {found(1, columns(0, 5), {0, 0.5F, 2}), found(2, columns(9, 12), {0, 3, 2})}, {}, {}};
  const auto people = track_people_of(frame, tracked, false);
  EXPECT_TRUE(people->sample.similarity.isApprox((Eigen::MatrixXd(1, 2) << 0.5, 0).finished()));
}

TEST(TrackSample, TakesAnyPlaceWhereOnlyTheNumberIsKnownAndTheMaskWhereThatIs) {
  TrueFrame frame = empty_frame();
  frame.truth.people = 1;
  frame.truth.ids = {0};
  const TrackedFrame tracked{0.0, {found(1, columns(0, 10)), found(2, columns(20, 30))}, {}, {}};
  EXPECT_TRUE(track_people_of(frame, tracked, false)->sample.similarity.isApprox(Eigen::MatrixXd::Ones(1, 2)));
  frame.truth.mask = columns(18, 30);
  const auto people = track_people_of(frame, tracked, false);
  EXPECT_TRUE(people->sample.similarity.isApprox((Eigen::MatrixXd(1, 2) << 0, 1).finished()));
}

TEST(TrackSample, DoesNotJudgeWhoIsBeyondThePeopleThatAreCertain) {
  TrueFrame frame = empty_frame();
  frame.truth.people = -1;
  frame.truth.ids = {0};
  TrackedFrame tracked{0.0, {found(1, columns(0, 10)), found(2, columns(20, 30))}, {}, {}};
  tracked.people[1].person.score = 0.9F;
  EXPECT_THAT(track_people_of(frame, tracked, false)->sample.found, ElementsAre(2));
}

TEST(TrackSample, NeedsIdsOfPeopleButNotOfNobody) {
  TrueFrame frame = empty_frame();
  frame.truth.people = 2;
  EXPECT_FALSE(track_people_of(frame, {}, false));
  frame.truth.people = 0;
  const auto people = track_people_of(frame, {0.0, {found(1, columns(0, 10))}, {}, {}}, false);
  ASSERT_TRUE(people);
  EXPECT_THAT(people->sample.truth, IsEmpty());
  EXPECT_THAT(people->sample.found, ElementsAre(1));
}

}  // namespace

}  // namespace vesalius
