#include "view/people_finder.h"

#include <gmock/gmock.h>

#include "stream/test_crossing.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A source whose frames are shown in any order.
class Shown {
 public:
  explicit Shown(bool with_looks = true)
      : detector_(std::make_shared<test::Knowing>(source_.frames())),
        history_(PeopleTracker(paper_body(), {}, with_looks ? detector_.appearance() : nullptr)) {
    for (const LabelledFrame& truth : source_.frames()) people_.push_back(detector_.detect(truth.frame));
  }

  /// Shows what was at a place of the source at a time.
  TrackedFrame show(int place, double time_s) {
    Frame frame = source_.frames().at(static_cast<std::size_t>(place)).frame;
    frame.time_s = time_s;
    return history_.before(time_s).update(frame, {people_.at(static_cast<std::size_t>(place))});
  }
  /// Shows a place at its time.
  TrackedFrame show(int place) { return show(place, time_of(place)); }
  /// Shows frames for so long that the first ones are forgotten, to and fro, since people do not jump.
  double show_long() {
    constexpr int kLong = 100, kLast = test::Crossing::kLength - 1;
    for (int i = 0; i < kLong; ++i) {
      const int place = i % (2 * kLast);
      show(place <= kLast ? place : 2 * kLast - place, time_of(i));
    }
    return time_of(kLong - 1);
  }
  TrackHistory& history() { return history_; }
  std::shared_ptr<const Appearance> appearance() const { return detector_.appearance(); }

  static double time_of(int place) { return place / kUsualRate; }

 private:
  test::Crossing source_;
  Detector detector_;
  std::vector<std::vector<Person>> people_;
  TrackHistory history_;
};

/// Ids with the letter of the state.
std::vector<std::string> told(const TrackedFrame& tracked) {
  std::vector<std::string> all;
  for (const TrackedPerson& person : tracked.people) all.push_back(std::to_string(person.id) + to_string(person.state));
  return all;
}

TEST(TrackHistory, AFrameShownAgainIsTheSame) {
  Shown shown;
  for (int again = 0; again < 5; ++again) {
    EXPECT_THAT(told(shown.show(0)), ElementsAre("1new", "2new")) << "a guess does not confirm itself";
  }
  std::vector<TrackedFrame> first;
  for (int i = 1; i < 8; ++i) first.push_back(shown.show(i));
  EXPECT_THAT(told(first.back()), ElementsAre("1tracked", "2tracked"));
  for (int again = 0; again < 3; ++again) {
    const TrackedFrame last = shown.show(7);
    EXPECT_EQ(told(last), told(first.back()));
    EXPECT_EQ(last.people[0].position, first.back().people[0].position);
    EXPECT_EQ(last.people[0].velocity, first.back().people[0].velocity);
  }
}

TEST(TrackHistory, WhoeverStepsBackSeesThePeopleOfThen) {
  Shown shown;
  std::vector<TrackedFrame> first;
  for (int i = 0; i < 8; ++i) first.push_back(shown.show(i));
  for (const int place : {7, 6, 5, 0, 1, 2, 3, 7, 1}) {
    const TrackedFrame now = shown.show(place);
    if (place == 7) continue;  // after those that were left out, a little different
    EXPECT_EQ(told(now), told(first[static_cast<std::size_t>(place)])) << place;
  }
}

TEST(TrackHistory, FramesThatWereDroppedDoNoHarm) {
  Shown shown;
  for (const int place : {0, 1, 2, 3, 6, 9, 10, 14, 15}) shown.show(place);
  EXPECT_THAT(told(shown.show(5)), ElementsAre("1tracked", "2tracked")) << "never shown before";
}

TEST(TrackHistory, FurtherBackIsAJumpThatUsesNoIdAgain) {
  Shown shown(false);  // nobody is known again by looks
  EXPECT_THAT(told(shown.show(0)), ElementsAre("1new", "2new"));
  const double end_s = shown.show_long();
  EXPECT_THAT(told(shown.show(0)), ElementsAre("3new", "4new"));
  EXPECT_THAT(told(shown.show(0)), ElementsAre("3new", "4new")) << "once more";
  shown.show(1);
  EXPECT_THAT(told(shown.show(2)), ElementsAre("3tracked", "4tracked"));
  const std::vector<std::string> later = told(shown.show(0, end_s + 60.0));
  EXPECT_THAT(later, ElementsAre("3lost", "4lost", "5new", "6new")) << "a jump ahead";
}

TEST(TrackHistory, ABeginningBeforeTheFirstFrameUsesNoIdAgain) {
  Shown shown(false);
  for (int i = 14; i < 20; ++i) shown.show(i);
  EXPECT_THAT(told(shown.show(0)), ElementsAre("3new", "4new"));
}

TEST(TrackHistory, BegunAnewItCountsOn) {
  Shown shown;
  for (int i = 0; i < 5; ++i) shown.show(i);
  TrackOptions options;
  options.confirm = 1;
  shown.history().restart(options, shown.appearance(), nullptr);
  EXPECT_THAT(told(shown.show(5)), ElementsAre("3tracked", "4tracked"));
  options.confirm = 0;
  EXPECT_THROW(shown.history().restart(options, shown.appearance(), nullptr), UsageError);
}

TEST(PeopleFinder, AddsWhomOtherCamerasSee) {
  test::Crossing source(true);
  const auto settings = std::make_shared<const FinderSettings>(
      FinderSettings{{}, Detector(std::make_shared<test::Knowing>(source.frames()))});
  std::vector<double> times;
  PeopleFinder finder(settings, true, [&](const Frame&, double time_s, TrackedFrame people) {
    times.push_back(time_s);
    people.people.emplace_back().id = 70;
    return people;
  });
  const auto played = std::make_shared<PlayedFrame>();
  played->frame = source.frames()[3].frame;
  const ViewedFrame viewed = finder.find(played, settings, false);
  ASSERT_EQ(viewed.people.people.size(), 3U);
  EXPECT_EQ(viewed.people.people.back().id, 70);
  EXPECT_THAT(times, ElementsAre(3 / kUsualRate));
}

}  // namespace
}  // namespace vesalius
