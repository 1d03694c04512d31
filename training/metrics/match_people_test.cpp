#include "metrics/match_people.h"

#include <gmock/gmock.h>

namespace vesalius {
namespace {

using Kind = Match::Kind;

constexpr int kWidth = 20;
const DepthImage kDepth(kWidth, 1, 1000);

/// Returns the pixels [begin, end) of a picture of one row.
Mask span(int begin, int end) {
  Mask mask(kWidth, 1, 0);
  for (int u = begin; u < end; ++u) mask(u, 0) = 1;
  return mask;
}

std::vector<Kind> kinds(const std::vector<Mask>& masks, const FrameTruth& truth) {
  std::vector<Proposal> proposals;
  for (const Mask& mask : masks) proposals.push_back({&mask, nullptr, 1.F});
  std::vector<Kind> kinds;
  for (const Match& match : match_people(proposals, truth, kDepth)) kinds.push_back(match.kind);
  return kinds;
}

TEST(MatchPeople, MatchesAnyPersonIfOnlyTheCountIsKnown) {
  FrameTruth truth;
  truth.people = 2;
  EXPECT_THAT(kinds({span(0, 1), span(1, 2), span(2, 3)}, truth),
              testing::ElementsAre(Kind::person, Kind::person, Kind::nobody));
  truth.people = 0;
  EXPECT_THAT(kinds({span(0, 1)}, truth), testing::ElementsAre(Kind::nobody));
  truth.people = -1;  // at least one person: one is right, more are undecided
  EXPECT_THAT(kinds({span(0, 1), span(1, 2)}, truth), testing::ElementsAre(Kind::person, Kind::ignored));
}

TEST(MatchPeople, RequiresProposalsOnTheCommonMask) {
  FrameTruth truth;
  truth.people = 1;
  truth.mask = span(0, 10);
  EXPECT_THAT(kinds({span(8, 13), span(6, 12), span(0, 5)}, truth),
              testing::ElementsAre(Kind::nobody, Kind::person, Kind::nobody));
}

/// Returns two people side by side whose pixels are known separately.
FrameTruth two_people() {
  FrameTruth truth;
  truth.people = 2;
  truth.person = Image<std::uint8_t>(kWidth, 1, kBackground);
  for (int u = 0; u < 8; ++u) truth.person(u, 0) = 0;
  for (int u = 10; u < 20; ++u) truth.person(u, 0) = 1;
  truth.joints.resize(2);
  return truth;
}

TEST(MatchPeople, MatchesEachPersonOnceByIou) {
  const FrameTruth truth = two_people();
  const Mask right = span(10, 18), again = span(10, 20), left = span(0, 4), small = span(0, 3);
  std::vector<Proposal> proposals;
  for (const Mask* mask : {&right, &again, &small, &left}) proposals.push_back({mask, nullptr, 1.F});
  const std::vector<Match> matches = match_people(proposals, truth, kDepth);
  EXPECT_EQ(matches[0].kind, Kind::person);
  EXPECT_EQ(matches[0].person, 1);
  EXPECT_EQ(matches[1].kind, Kind::nobody);  // the same person again
  EXPECT_EQ(matches[2].kind, Kind::nobody);  // IoU 3/8
  EXPECT_EQ(matches[3].kind, Kind::person);  // IoU 4/8
  EXPECT_EQ(matches[3].person, 0);
}

TEST(MatchPeople, IgnoresPixelsWithoutReading) {
  const FrameTruth truth = two_people();
  DepthImage depth = kDepth;
  for (int u = 3; u < 8; ++u) depth(u, 0) = 0;
  const Mask small = span(0, 3);
  EXPECT_EQ(match_people({{&small, nullptr, 1.F}}, truth, depth)[0].kind, Kind::person);
}

TEST(VisiblePeople, ComeBeforePeopleWhoAreMostlyHidden) {
  TrueFrame frame;
  frame.frame.depth = kDepth;
  frame.frame.camera = {kWidth, 1, 10.F, 10.F, 10.F, 0.F};  // 100 cm^2 a pixel at 1 m
  frame.truth = two_people();
  for (int u = 4; u < 8; ++u) frame.truth.person(u, 0) = kBackground;  // 400 cm^2 are left of person 0
  frame.truth.joint_names = {"head"};
  frame.truth.joints = {{{1, 0, 0}}, {{2, 0, 0}}};
  frame.truth.parts = {{{3, 0, 0}}, {{4, 0, 0}}};
  frame.truth.postures = {"sitting", "standing"};
  frame.truth.statures_m = {1.5F, 1.8F};
  put_visible_people_first(frame);
  EXPECT_EQ(frame.truth.people, 1);
  EXPECT_EQ(frame.truth.joints[0][0].x(), 2.F);
  EXPECT_EQ(frame.truth.parts[0][0].x(), 4.F);
  EXPECT_THAT(frame.truth.postures, testing::ElementsAre("standing", "sitting"));
  EXPECT_THAT(frame.truth.statures_m, testing::ElementsAre(1.8F, 1.5F));
  EXPECT_EQ(frame.truth.person(15, 0), 0);
  EXPECT_EQ(frame.truth.person(0, 0), 1);
  EXPECT_EQ(frame.truth.person(9, 0), kBackground);
  EXPECT_THAT(kinds({span(0, 4), span(10, 20)}, frame.truth), testing::ElementsAre(Kind::ignored, Kind::person));
}

TEST(DistinctProposals, LeaveOutRepetitionsWithLowerScores) {
  Trace trace;
  const auto add = [&](const Mask& mask, int found, float score) {
    trace.candidates.emplace_back();
    trace.candidates.back().grown = mask;
    trace.candidates.back().refined.found = found;
    trace.candidates.back().score = score;
  };
  add(span(0, 10), 12, 0.9F);
  add(span(6, 16), 8, 0.8F);   // shares 4 of 10
  add(span(8, 18), 5, 0.4F);   // shares 2 of 10
  add(span(19, 20), 0, 0.1F);  // no skeleton
  const std::vector<Proposal> proposals = distinct_proposals(trace, 0.3F);
  ASSERT_EQ(proposals.size(), 2U);
  EXPECT_EQ(proposals[0].skeleton->found, 12);
  EXPECT_EQ(proposals[1].skeleton->found, 5);
  EXPECT_TRUE(distinct_proposals(Trace{}, 0.3F).empty());
}

}  // namespace
}  // namespace vesalius
