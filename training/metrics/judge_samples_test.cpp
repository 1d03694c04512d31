#include "metrics/judge_samples.h"

#include <gmock/gmock.h>

namespace vesalius {
namespace {

/// Returns a candidate whose mask has the given columns of a picture of 10 x 1.
Trace trace_of(int from, int to) {
  Trace trace;
  Trace::Candidate candidate;
  candidate.grown = Mask(10, 1, 0);
  for (int u = from; u < to; ++u) candidate.grown(u, 0) = 1;
  candidate.refined.found = 7;
  trace.candidates.push_back(candidate);
  return trace;
}

TEST(JudgeSamples, AreJudgedByTheirOverlap) {
  const DepthImage depth(10, 1, 2000);
  FrameTruth truth;
  truth.people = 1;
  truth.person = Image<std::uint8_t>(10, 1, kBackground);
  for (int u = 0; u < 4; ++u) truth.person(u, 0) = 0;
  const auto kinds = [&](const FrameTruth& known, int from, int to) {
    std::vector<int> all;
    for (const BoostSample& s : judge_samples(trace_of(from, to), known, depth)) all.push_back(s.positive ? 1 : 0);
    return all;
  };
  EXPECT_THAT(kinds(truth, 0, 4), testing::ElementsAre(1));
  EXPECT_THAT(kinds(truth, 2, 4), testing::ElementsAre(1));  // IoU 0.5
  EXPECT_THAT(kinds(truth, 2, 6), testing::IsEmpty());       // IoU 1/3, which is undecided
  EXPECT_THAT(kinds(truth, 0, 1), testing::IsEmpty());       // a piece of a person
  EXPECT_THAT(kinds(truth, 5, 9), testing::ElementsAre(0));

  FrameTruth mask_only;
  mask_only.people = 1;
  mask_only.mask = Mask(10, 1, 0);
  for (int u = 0; u < 4; ++u) mask_only.mask(u, 0) = 255;
  EXPECT_THAT(kinds(mask_only, 2, 6), testing::ElementsAre(1));
  EXPECT_THAT(kinds(mask_only, 3, 6), testing::IsEmpty());
  EXPECT_THAT(kinds(mask_only, 2, 10), testing::ElementsAre(1));  // covers half of the mask
  EXPECT_THAT(kinds(mask_only, 4, 6), testing::ElementsAre(0));

  FrameTruth empty;
  empty.people = 0;
  EXPECT_THAT(kinds(empty, 0, 4), testing::ElementsAre(0));
  EXPECT_THAT(kinds({}, 0, 4), testing::IsEmpty());
}

}  // namespace
}  // namespace vesalius
