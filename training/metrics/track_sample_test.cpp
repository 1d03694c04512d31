#include "metrics/track_sample.h"

#include <gmock/gmock.h>

#include "metrics/match_people.h"

namespace vesalius {
namespace {

using testing::ElementsAre;
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
