// These tests check that the metrics of data/accuracy.toml do not get worse.

#include <gmock/gmock.h>

#include <iostream>

#include "accuracy_guard.h"
#include "io/files/data_file.h"
#include "shared_frames.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kProject = VESALIUS_SOURCE_DIR;

std::vector<AcceptedSet> accepted_sets() {
  const std::string path = kProject + "/data/accuracy.toml";
  return parse_accuracy(read_file(path), path);
}

void expect_as_good(const AcceptedSet& set, const std::string& source) {
  const MeasuredSet now = measure(set, kProject, source);
  std::cout << set.source << " by " << set.model << ", " << now.frames << " frames:";
  for (const AcceptedMetric& metric : set.metrics) {
    const auto found = now.metrics.find(metric.name);
    if (found != now.metrics.end()) std::cout << ' ' << metric.name << ' ' << found->second;
  }
  std::cout << '\n';
  const std::vector<std::string> worse = what_got_worse(set, now);
  for (const std::string& line : worse) ADD_FAILURE() << line;
  if (!worse.empty()) std::cout << "As it is now, where that is meant:\n" << accuracy_toml(set, now);
}

// Labels: real
TEST(Accuracy, IsAsGoodAsAcceptedOnBundledFrames) {
  int sets = 0;
  for (const AcceptedSet& set : accepted_sets()) {
    if (set.shared()) continue;
    ++sets;
    expect_as_good(set, kProject + "/" + set.source);
  }
  EXPECT_GT(sets, 0);
}

// Labels: real
TEST(Accuracy, IsAsGoodAsAcceptedOnRealFrames) {
  VESALIUS_NEEDS_SHARED();
  int sets = 0;
  for (const AcceptedSet& set : accepted_sets()) {
    if (!set.shared()) continue;
    ++sets;
    expect_as_good(set, (shared / set.source.substr(std::string("shared:").size())).string());
  }
  if (sets == 0) GTEST_SKIP() << "data/accuracy.toml accepts nothing on real frames";
}

AcceptedSet small_set() {
  return {"m.forest", "room", 1, {"a"}, {"z"}, {{"people.found", 0.9, 0.02}, {"people.false", 0.1, 0.05}}};
}

TEST(AccuracyGuard, AcceptsDifferencesWithinTheTolerances) {
  EXPECT_THAT(what_got_worse(small_set(), {10, {"a", "b"}, {}, {{"people.found", 0.88}, {"people.false", 0.15}}}),
              IsEmpty());
  EXPECT_THAT(what_got_worse(small_set(), {10, {}, {}, {{"people.found", 1.0}, {"people.false", 0.0}}}), IsEmpty());
}

TEST(AccuracyGuard, NamesMetricsAndFramesThatGotWorse) {
  const MeasuredSet now{10, {"b", "c"}, {"y", "z"}, {{"people.found", 0.87}, {"people.false", 0.1}}};
  EXPECT_THAT(what_got_worse(small_set(), now),
              ElementsAre("room: people.found is 0.8700, accepted were 0.9000 with a tolerance of 0.02",
                          "room: somebody is missed who was found: b c", "room: somebody is found who was missed: a",
                          "room: nobody is taken for somebody, and was not: y"));
  const MeasuredSet haunted{10, {"a"}, {}, {{"people.found", 0.9}, {"people.false", 0.2}}};
  EXPECT_THAT(what_got_worse(small_set(), haunted),
              ElementsAre("room: people.false is 0.2000, accepted were 0.1000 with a tolerance of 0.05",
                          "room: nobody was taken for somebody, and is no more: z"));
  EXPECT_THAT(what_got_worse(small_set(), {10, {"a"}, {"z"}, {{"people.false", 0.1}}}),
              ElementsAre("room: no people.found any more"));
}

TEST(AccuracyGuard, ReadsTheTextThatItWrites) {
  const MeasuredSet now{10, {"b"}, {}, {{"people.found", 0.875}, {"people.false", 0.0}}};
  const auto read = parse_accuracy(accuracy_toml(small_set(), now), "t");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].source, "room");
  EXPECT_THAT(read[0].missed, ElementsAre("b"));
  EXPECT_THAT(read[0].false_people, IsEmpty());
  ASSERT_EQ(read[0].metrics.size(), 2U);
  EXPECT_EQ(read[0].metrics[0].value, 0.875);
  EXPECT_EQ(read[0].metrics[0].tolerance, 0.02);
}

TEST(AccuracyGuard, NamesTheLineOfErrors) {
  const auto error = [](const std::string& toml) -> std::string {
    try {
      parse_accuracy(toml, "t");
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(error("[[set]\n"), HasSubstr("t:1: "));
  EXPECT_THAT(error("a = 1\n"), HasSubstr("t:1: expected set, found a"));
  EXPECT_THAT(error("[[set]]\nmodel = \"m\"\n"), HasSubstr("t:1: expected a value for source"));
  const std::string good = "[[set]]\nmodel = \"m\"\nsource = \"s\"\nstep = 1\nmissed = []\nfalse_people = []\n";
  EXPECT_THAT(error(good), HasSubstr("expected [[set.figure]]"));
  EXPECT_THAT(error(good + "[[set.figure]]\nname = \"n\"\nvalue = 1.0\n"),
              HasSubstr("t:7: expected a metric of docs/metrics.md, found n"));
  EXPECT_THAT(error(good + "[[set.figure]]\nname = \"mask.iou\"\nvalue = 1.0\n"),
              HasSubstr("t:7: expected a value for tol"));
}

}  // namespace
}  // namespace vesalius
