#include "view/happenings.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

constexpr double kGap_s = 5.0;

TrackedPerson person_in(int id, TrackState state, double seen_s, Stance stance = Stance::unknown) {
  TrackedPerson person;
  person.id = id;
  person.state = state;
  person.seen_s = seen_s;
  person.stance = stance;
  return person;
}

/// A person who is a guess at 1 s, sure at 1.1 s, hidden from 3 s on and lost at 4 s, beside one who is always there;
/// of the first one it is told at 2.5 s that she sits since 2 s.
TrackedFrame frame_at(double time_s, int id = 2) {
  TrackedFrame frame;
  frame.time_s = time_s;
  frame.people.push_back(person_in(1, time_s < 0.1 ? TrackState::fresh : TrackState::tracked, time_s));
  const Stance stance = time_s < 2.45 ? Stance::standing : Stance::sitting;
  const auto add = [&](TrackState state) {
    frame.people.push_back(person_in(id, state, std::min(time_s, 2.9), stance));
  };
  if (time_s > 0.95 && time_s < 1.05) add(TrackState::fresh);
  if (time_s > 1.05 && time_s < 2.95) add(TrackState::tracked);
  if (time_s > 2.95 && time_s < 3.95) add(TrackState::hidden);
  if (time_s > 3.95 && time_s < 4.05) add(TrackState::lost);
  if (time_s > 2.45 && time_s < 2.55) frame.events.push_back({id, 2.0, Stance::sitting});
  return frame;
}

/// Shows frames of ten a second, from the first to the last.
void show(Happenings& happenings, int from, int to, int id = 2) {
  for (int i = from; i <= to; ++i) happenings.add(0.1 * i, frame_at(0.1 * i, id), 1.0, kGap_s);
}

std::vector<std::string> told(const Happenings& happenings) {
  std::vector<std::string> all;
  for (const Happening& one : happenings.events()) {
    all.push_back(fmt::format("{:.1f} {} {} {}", one.at_s, one.id, one.what, to_string(one.before)));
  }
  return all;
}

const auto kAll = ElementsAre("1.0 2 came unknown", "2.0 2 sitting standing", "2.9 2 went sitting");

TEST(Happenings, TellWhoCameChangedAndWent) {
  Happenings happenings;
  show(happenings, 0, 20);
  EXPECT_THAT(told(happenings), ElementsAre("1.0 2 came unknown")) << "and not who was there at the beginning";
  show(happenings, 21, 50);
  EXPECT_THAT(told(happenings), kAll);
}

TEST(Happenings, AreToldOnceHoweverOneMoves) {
  Happenings happenings;
  show(happenings, 0, 50);
  show(happenings, 50, 50);
  for (int i = 49; i >= 0; --i) show(happenings, i, i);  // step by step back
  EXPECT_THAT(told(happenings), kAll);
  for (const int from : {0, 15, 22, 25, 35, 5}) {
    show(happenings, from, 50);
    EXPECT_THAT(told(happenings), kAll) << from;
  }
  show(happenings, 12, 18);
  show(happenings, 100, 110);
  EXPECT_THAT(told(happenings), kAll) << "a jump tells nothing";
}

TEST(Happenings, ANewIdIsTheSamePersonAgain) {
  Happenings happenings;
  show(happenings, 0, 50);
  show(happenings, 0, 50, 7);
  EXPECT_THAT(told(happenings), ElementsAre("1.0 7 came unknown", "2.0 7 sitting standing", "2.9 7 went sitting"));
}

TEST(Happenings, TwoWhoComeTogetherAreTwo) {
  Happenings happenings;
  for (int again = 0; again < 2; ++again) {
    for (const double at_s : {0.0, 0.1, 0.2}) {
      TrackedFrame frame;
      frame.time_s = at_s;
      for (int id = 1; at_s > 0.0 && id <= 2; ++id) frame.people.push_back(person_in(id, TrackState::tracked, at_s));
      happenings.add(at_s, frame, 1.0, kGap_s);
    }
    EXPECT_THAT(told(happenings), ElementsAre("0.1 1 came unknown", "0.1 2 came unknown"));
  }
}

TEST(Happenings, GuessesNeitherComeNorGo) {
  Happenings happenings;
  for (const double at_s : {0.0, 0.1, 0.2}) {
    TrackedFrame frame;
    frame.time_s = at_s;
    if (at_s == 0.1) frame.people.push_back(person_in(1, TrackState::fresh, at_s));
    happenings.add(at_s, frame, 1.0, kGap_s);
  }
  EXPECT_THAT(told(happenings), IsEmpty());
  EXPECT_THAT(happenings.seen().list(), IsEmpty());
}

TEST(Happenings, PlacesAreThoseOfTheSource) {
  Happenings happenings;  // frames without times, ten a second, which the source counts as thirty
  for (int i = 0; i <= 50; ++i) happenings.add(0.1 * i / 3, frame_at(0.1 * i), 3.0, kGap_s);
  EXPECT_THAT(told(happenings), ElementsAre("0.3 2 came unknown", "0.7 2 sitting standing", "1.0 2 went sitting"));
}

TEST(Happenings, KnowWhereSomebodyIs) {
  Happenings happenings;
  for (int i = 0; i <= 40; ++i) {
    TrackedFrame frame;
    frame.time_s = 0.1 * i;
    if (i >= 10 && i <= 20) frame.people.push_back(person_in(1, TrackState::tracked, frame.time_s));
    if (i == 21) frame.people.push_back(person_in(1, TrackState::hidden, 2.0));
    happenings.add(0.1 * i, frame, 1.0, kGap_s);
  }
  EXPECT_THAT(happenings.known().list(), ElementsAre(Pair(0.0, 4.0)));
  EXPECT_THAT(happenings.seen().list(), ElementsAre(Pair(testing::DoubleNear(0.9, 1e-9), 2.0)));
  happenings.add(20.0, seen_people({{}}), 1.0, kGap_s);
  EXPECT_EQ(happenings.known().list().size(), 2U) << "a jump";
  EXPECT_THAT(happenings.seen().list().back(), Pair(20.0, 20.0));
}

TEST(Happenings, AreBounded) {
  Happenings happenings;
  for (int i = 0; i < 3000; ++i) {
    TrackedFrame frame;
    frame.time_s = i;
    if (i % 2 == 1) frame.people.push_back(person_in(i, TrackState::tracked, i));
    happenings.add(i, frame, 1.0, kGap_s);
  }
  EXPECT_EQ(happenings.events().size(), 500U);
  EXPECT_EQ(happenings.events().back().id, 2999);
  EXPECT_LE(happenings.seen().list().size(), 500U);
  EXPECT_EQ(happenings.seen().list().back(), std::pair(2998.0, 2999.0));
}

TEST(Stretches, AreJoinedAndCut) {
  Stretches stretches;
  stretches.add({1, 2});
  stretches.add({5, 6});
  stretches.add({2, 3});
  EXPECT_THAT(stretches.list(), ElementsAre(Pair(1, 3), Pair(5, 6)));
  stretches.add({0, 5.5});
  EXPECT_THAT(stretches.list(), ElementsAre(Pair(0, 6)));
  stretches.remove({2, 3});
  stretches.remove({5, 9});
  EXPECT_THAT(stretches.list(), ElementsAre(Pair(0, 2), Pair(3, 5)));
  stretches.remove({-1, 2});
  EXPECT_THAT(stretches.list(), ElementsAre(Pair(3, 5)));
}

}  // namespace
}  // namespace vesalius
