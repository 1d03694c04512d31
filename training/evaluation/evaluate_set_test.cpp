#include "evaluation/evaluate_set.h"

#include <gmock/gmock.h>

#include <memory>

#include "capsule/capsule_person.h"
#include "dataset/labelled_truth.h"
#include "dataset/open_truth.h"
#include "evaluation/evaluation_json.h"
#include "evaluation/evaluation_report.h"
#include "io/files/test_files.h"
#include "vesalius/error.h"
#include "vesalius/forest/test_blind_labeller.h"

namespace vesalius {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Camera kCamera{80, 60, 65.F, 65.F, 39.5F, 29.5F};

FrameScorer blind_scorer() { return FrameScorer(std::make_shared<test::BlindLabeller>(), {}); }

/// Frames of one person each. Those whose index is in `damaged` cannot be read.
class Frames : public TruthSource {
 public:
  explicit Frames(int count, std::vector<int> damaged = {}, std::vector<std::string> parts = {})
      : count_(count), damaged_(std::move(damaged)), parts_(std::move(parts)) {}

  std::optional<TrueFrame> next() override {
    const int index = next_++;
    if (index >= count_) return std::nullopt;
    if (std::ranges::find(damaged_, index) != damaged_.end()) throw Error(std::to_string(index) + ": damaged");
    CapsuleScene scene;
    scene.people.emplace_back();
    TrueFrame frame = as_true_frame(render(scene, kCamera, paper_body()));
    frame.frame.name = "f" + std::to_string(index);
    return frame;
  }
  int size() const override { return count_; }
  std::vector<std::string> notes() const override { return {"made for a test"}; }
  std::vector<std::string> part_names() const override { return parts_; }

 private:
  int count_;
  std::vector<int> damaged_;
  std::vector<std::string> parts_;
  int next_ = 0;
};

TEST(EvaluateSet, SumsAllFramesAndKeepsTheWorst) {
  Frames frames(12);
  const SetResult set = evaluate_set(frames, {"room", "memory"}, blind_scorer());
  EXPECT_EQ(set.frames, 12);
  EXPECT_EQ(set.failed, 0);
  EXPECT_THAT(set.notes, ElementsAre("made for a test"));
  const std::vector<Estimate> estimates = set.metrics.estimates();
  const Estimate* found = find_estimate(estimates, Metric::people_found);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->numerator, 0.0);
  EXPECT_EQ(found->denominator, 12.0);
  EXPECT_EQ(set.worst.size(), 3U);
  EXPECT_THAT(set.worst.front().score.what_went_wrong, HasSubstr("1 of 1 people missed"));
  EXPECT_THAT(
      summary_lines(set),
      ContainsRegex("^room: 12 frames, .*\n  found     0 of 12 people, 0.00 % .*\n  false     0, 0.000 a frame"));
}

TEST(EvaluateSet, ReportsFailuresAndContinuesIfAsked) {
  Frames stops(5, {2});
  EXPECT_THAT(
      [&] {
        evaluate_set(stops, {"room", "memory"}, blind_scorer());
      },
      ThrowsMessage<Error>(HasSubstr("2: damaged")));
  Frames goes_on(5, {2});
  std::vector<std::string> failures;
  EvaluationHooks hooks;
  int last = 0;
  hooks.failure = [&](const std::string& why) { failures.push_back(why); };
  hooks.progress = [&](int done, int total) {
    last = done;
    EXPECT_EQ(total, 5);
  };
  const SetResult set = evaluate_set(goes_on, {"room", "memory", true}, blind_scorer(), hooks);
  EXPECT_EQ(set.frames, 4);
  EXPECT_EQ(set.failed, 1);
  EXPECT_THAT(failures, ElementsAre("2: damaged"));
  EXPECT_EQ(set.failures, failures);
  EXPECT_EQ(last, 4);
}

TEST(EvaluateSet, RefusesOtherPartsAndEmptySourcesAndCanBeStopped) {
  Frames other(1, {}, {"tail"});
  EXPECT_THAT(
      [&] {
        evaluate_set(other, {"a", "memory"}, blind_scorer());
      },
      ThrowsMessage<Error>(HasSubstr("memory: part 0 is tail, in the model l_foot")));
  Frames none(0);
  EXPECT_THAT(
      [&] {
        evaluate_set(none, {"a", "memory"}, blind_scorer());
      },
      ThrowsMessage<Error>(HasSubstr("memory: no frame that could be evaluated")));
  Frames many(1000);
  EvaluationHooks hooks;
  hooks.stop = [] { return true; };
  EXPECT_THAT(
      [&] {
        evaluate_set(many, {"a", "memory"}, blind_scorer(), hooks);
      },
      ThrowsMessage<Error>(HasSubstr("a: interrupted after ")));
}

TEST(EvaluationJson, IsReadBackAsWritten) {
  Frames frames(4);
  Evaluation evaluation;
  evaluation.body = paper_body();
  evaluation.sets.push_back(evaluate_set(frames, {"room", "memory"}, blind_scorer()));
  const test::TemporaryFolder folder;
  test::put(folder / "a.json", evaluation_json(evaluation));
  const std::vector<StoredSet> sets = read_evaluation(folder / "a.json");
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_EQ(sets[0].name, "room");
  const std::vector<Estimate> written = evaluation.sets[0].metrics.estimates();
  ASSERT_EQ(sets[0].metrics.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_EQ(sets[0].metrics[i].id.name(), written[i].id.name());
    EXPECT_DOUBLE_EQ(sets[0].metrics[i].value, written[i].value);
  }
  const std::vector<SetComparison> same = compare_evaluations(sets, sets);
  ASSERT_EQ(same.size(), 1U);
  EXPECT_TRUE(same[0].paired);
  for (const Comparison& c : same[0].metrics) EXPECT_EQ(c.verdict, Comparison::Verdict::same) << c.id.name();
  EXPECT_FALSE(compare_evaluations(sets, {}).at(0).in_both);
}

}  // namespace
}  // namespace vesalius
