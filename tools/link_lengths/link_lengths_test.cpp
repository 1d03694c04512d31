#include "link_lengths.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vesalius {
namespace {

/// Returns a body of a shin and a foot on either side.
BodyModel legs() {
  BodyModel body;
  for (const char* name : {"l_shin", "l_foot", "r_shin", "r_foot"}) {
    BodyPart part;
    part.name = name;
    part.max_extent_m = 1.F;
    part.typical_area_m2 = 0.02F;
    part.mirror = (body.part_count() + 2) % 4;
    body.parts.push_back(part);
  }
  body.links = {{0, 1, 0.2F, 0.1F}, {2, 3, 0.2F, 0.1F}};
  return body;
}

/// A flat picture 2 m away, of which a pixel is 1 cm.
TrueFrame empty_frame(std::vector<float> statures_m) {
  TrueFrame frame;
  frame.frame.camera = {100, 100, 200.F, 200.F, 50.F, 50.F};
  frame.frame.depth = DepthImage(100, 100, 2000);
  frame.truth.labels = LabelImage(100, 100, kBackground);
  frame.truth.person = Image<std::uint8_t>(100, 100, kBackground);
  frame.truth.statures_m = std::move(statures_m);
  return frame;
}

/// Paints a part as a square of 8 cm whose upper left corner is (u, v).
void paint(TrueFrame& frame, int person, int label, int u, int v) {
  for (int y = v; y < v + 8; ++y) {
    for (int x = u; x < u + 8; ++x) {
      frame.truth.labels(x, y) = static_cast<std::uint8_t>(label);
      frame.truth.person(x, y) = static_cast<std::uint8_t>(person);
    }
  }
}

/// Returns a frame of one person whose left shin and foot, or the right ones, are so far apart.
TrueFrame person(float stature_m, int distance_cm, int side = 0) {
  TrueFrame frame = empty_frame({stature_m});
  paint(frame, 0, 2 * side, 20, 10);
  paint(frame, 0, 2 * side + 1, 20, 10 + distance_cm);
  return frame;
}

std::vector<LinkFigures> measure(const std::vector<TrueFrame>& frames) {
  const BodyModel body = legs();
  LinkLengths lengths(body);
  for (const TrueFrame& frame : frames) lengths.add(frame, frame.truth.labels);
  return lengths.figures();
}

TEST(LinkLengths, MeasureTheDistanceOfBothSidesTogether) {
  const std::vector<LinkFigures> figures = measure({person(1.7F, 20), person(1.7F, 30, 1), person(1.7F, 26, 1)});
  ASSERT_EQ(figures.size(), 2U);
  for (const LinkFigures& link : figures) {
    EXPECT_EQ(link.pairs, 3);
    EXPECT_NEAR(link.length_m, 0.26F, 1e-4F);
    EXPECT_NEAR(link.spread_m, 0.06F, 1e-4F);
    EXPECT_NEAR(link.scaled_spread_m, 0.06F, 1e-4F);
    EXPECT_NEAR(link.band_m[3], 0.26F, 1e-4F);
    EXPECT_TRUE(std::isnan(link.band_m[0]));
  }
}

TEST(LinkLengths, LetStaturesWeighAlike) {
  std::vector<TrueFrame> frames(9, person(1.7F, 30));
  for (const float stature : {1.1F, 1.3F}) frames.push_back(person(stature, 15));
  EXPECT_NEAR(measure(frames)[0].length_m, 0.15F, 1e-4F) << "two bands of three";
}

TEST(LinkLengths, SpreadLessAfterScalingWherePeopleAreSimilarInShape) {
  const LinkFigures link = measure({person(0.85F, 15), person(1.7F, 30)})[0];
  EXPECT_NEAR(link.spread_m, 0.15F, 1e-4F);
  EXPECT_NEAR(link.scaled_spread_m, 0.F, 1e-4F);
}

TEST(LinkLengths, TakeTheLargestClusterOfEachPersonAlone) {
  TrueFrame frame = empty_frame({1.7F, 1.7F});
  paint(frame, 0, 0, 10, 10);
  paint(frame, 1, 1, 10, 20);  // another person's foot
  EXPECT_EQ(measure({frame})[0].pairs, 0);
  paint(frame, 0, 1, 10, 50);
  paint(frame, 0, 1, 10, 52);  // 8 x 10 cm, its centre at 54.5 + 0.5
  paint(frame, 0, 1, 80, 80);
  EXPECT_NEAR(measure({frame})[0].length_m, 0.41F, 1e-4F);
}

TEST(LinkLengths, LeaveOutPeopleOfUnknownStature) { EXPECT_EQ(measure({person(NAN, 20)})[0].pairs, 0); }

}  // namespace
}  // namespace vesalius
