#include "eval/breakdown_metrics.h"

#include <gmock/gmock.h>

#include <numbers>
#include <set>

#include "capsule/capsule_person.h"

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.25F, 131.25F, 79.5F, 59.5F};

/// Returns a frame of a capsule person at this distance, turned about the vertical.
TrueFrame frame_of(float distance_m, float turn_rad) {
  CapsuleScene scene;
  CapsulePerson person;
  person.feet.z() = distance_m;
  person.pose.yaw = turn_rad;
  scene.people.push_back(person);
  LabelledFrame labelled = render(scene, kCamera, paper_body());
  TrueFrame frame;
  frame.frame = std::move(labelled.frame);
  frame.truth.people = 1;
  frame.truth.joints = std::move(labelled.parts);
  frame.truth.person = std::move(labelled.person);
  frame.truth.labels = std::move(labelled.labels);
  return frame;
}

std::set<std::string> names(const MetricTerms& terms) {
  std::set<std::string> all;
  for (const MetricTerm& term : terms) all.insert(term.id.name());
  return all;
}

TEST(Breakdown, CountsByDistanceHeadingAndVisibleShare) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const Person found;
  EXPECT_THAT(names(breakdown_terms(frame_of(2.5F, 0.F), {&found}, paper_body())),
              testing::IsSupersetOf({"distance.2-3m", "heading.front", "visible.75-100%"}));
  EXPECT_THAT(names(breakdown_terms(frame_of(3.5F, kPi), {&found}, paper_body())),
              testing::IsSupersetOf({"distance.3-4m", "heading.back"}));
  EXPECT_THAT(names(breakdown_terms(frame_of(5.5F, kPi / 2.F), {&found}, paper_body())),
              testing::IsSupersetOf({"distance.4m-", "heading.side"}));
}

TEST(Breakdown, CountsFoundPeople) {
  const TrueFrame frame = frame_of(2.5F, 0.F);
  const Person found;
  for (const MetricTerm& term : breakdown_terms(frame, {&found}, paper_body())) EXPECT_EQ(term.numerator, 1.0);
  for (const MetricTerm& term : breakdown_terms(frame, {nullptr}, paper_body())) {
    EXPECT_EQ(term.numerator, 0.0);
    EXPECT_EQ(term.denominator, 1.0);
  }
}

TEST(Breakdown, CountsHiddenPartsAsNotVisible) {
  TrueFrame frame = frame_of(2.5F, 0.F);
  for (int v = 45; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) frame.truth.labels(u, v) = kBackground;
  }
  const auto all = names(breakdown_terms(frame, {nullptr}, paper_body()));
  EXPECT_FALSE(all.contains("visible.75-100%"));
}

TEST(Breakdown, IsEmptyWithoutLabels) {
  TrueFrame frame = frame_of(2.5F, 0.F);
  frame.truth.labels = {};
  EXPECT_TRUE(breakdown_terms(frame, {nullptr}, paper_body()).empty());
}

}  // namespace
}  // namespace vesalius
