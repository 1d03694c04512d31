#include "vesalius/draw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

BodyModel three_parts() {
  BodyModel body;
  body.parts = {{.name = "head", .colour = {250, 10, 20}},
                {.name = "chest", .colour = {30, 240, 40}},
                {.name = "hips", .colour = {50, 60, 230}}};
  body.links = {{.parent = 0, .child = 1}, {.parent = 1, .child = 2}};
  return body;
}

Frame plain_frame(int width, int height) {
  Frame frame;
  frame.camera = {width, height, 500.F, 500.F, static_cast<float>(width) / 2.F, static_cast<float>(height) / 2.F};
  frame.depth = DepthImage(width, height, 2000);
  frame.colour = ColourImage(width, height, {90, 90, 90});
  return frame;
}

Person person_of(const Frame& frame, const BodyModel& body) {
  Person person;
  person.mask = Mask(frame.depth.width(), frame.depth.height());
  person.skeleton.parts.resize(body.parts.size());
  return person;
}

void put(Person& person, const Frame& frame, int part, float u, float v, State state) {
  SkeletonPart& p = person.skeleton.parts[part];
  p.state = state;
  p.centre = frame.camera.point(u, v, 2.F);
}

long count(const ColourImage& image, Rgb colour) { return std::count(image.begin(), image.end(), colour); }

TEST(DrawDepth, DrawsOnlyHolesInBlack) {
  DepthImage depth(40, 30);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = static_cast<std::uint16_t>(i % 3 == 0 ? 0 : 500 + i);
  const ColourImage picture = draw_depth(depth);
  ASSERT_TRUE(picture.same_size(depth));
  for (std::size_t i = 0; i < depth.size(); ++i) EXPECT_EQ(picture[i] == (Rgb{0, 0, 0}), depth[i] == 0) << i;
}

TEST(DrawDepth, DrawsNearWarmAndFarCold) {
  DepthImage depth(100, 10);
  for (int v = 0; v < 10; ++v)
    for (int u = 0; u < 100; ++u) depth(u, v) = static_cast<std::uint16_t>(1000 + 10 * u);
  const ColourImage picture = draw_depth(depth);
  EXPECT_GT(picture(5, 5).r, 2 * picture(5, 5).b);
  EXPECT_GT(picture(85, 5).b, 2 * picture(85, 5).r);
}

TEST(DrawDepth, IgnoresOutliersInTheRange) {
  DepthImage depth(100, 10);
  for (int v = 0; v < 10; ++v)
    for (int u = 0; u < 100; ++u) depth(u, v) = static_cast<std::uint16_t>(1000 + 10 * u);
  const ColourImage plain = draw_depth(depth);
  depth(99, 5) = 65535;
  depth(0, 5) = 1;
  const ColourImage with_outliers = draw_depth(depth);
  EXPECT_EQ(with_outliers(20, 0), plain(20, 0));
  EXPECT_EQ(with_outliers(99, 5), plain(99, 0));
  EXPECT_EQ(with_outliers(0, 5), plain(0, 0));
}

TEST(DrawDepth, DrawsFlatEmptyAndBlankPictures) {
  EXPECT_TRUE(draw_depth(DepthImage()).empty());
  EXPECT_EQ(count(draw_depth(DepthImage(8, 8)), {0, 0, 0}), 64);
  EXPECT_EQ(count(draw_depth(DepthImage(8, 8, 1500)), {0, 0, 0}), 0);
}

TEST(DrawLabels, DrawsPartColoursOverDarkDepth) {
  const BodyModel body = three_parts();
  DepthImage depth(640, 480, 3000);
  depth(1, 1) = 1000;
  depth(2, 2) = 0;
  LabelImage labels(640, 480, kBackground);
  labels(10, 20) = 0;
  labels(11, 20) = 2;
  const ColourImage picture = draw_labels(labels, depth, body, false);
  ASSERT_TRUE(picture.same_size(depth));
  EXPECT_EQ(picture(10, 20), body.parts[0].colour);
  EXPECT_EQ(picture(11, 20), body.parts[2].colour);
  EXPECT_EQ(picture(2, 2), (Rgb{0, 0, 0}));
  EXPECT_EQ(picture(100, 100).r, picture(100, 100).b);
  EXPECT_LT(picture(100, 100).r, 128);
  EXPECT_GT(picture(100, 100).r, 0);
}

TEST(DrawLabels, DrawsTheLegendBesideThePicture) {
  BodyModel body = three_parts();
  for (int i = 0; i < 40; ++i)  // more than one column
    body.parts.push_back({.name = "part" + std::to_string(i), .colour = {static_cast<std::uint8_t>(100 + i), 3, 200}});
  const DepthImage depth(640, 480, 3000);
  const LabelImage labels(640, 480, kBackground);
  const ColourImage bare = draw_labels(labels, depth, body, false);
  const ColourImage legend = draw_labels(labels, depth, body, true);
  ASSERT_GT(legend.width(), 640);
  ASSERT_EQ(legend.height(), 480);
  for (int v = 0; v < 480; ++v) ASSERT_TRUE(std::equal(bare.row(v), bare.row(v) + 640, legend.row(v)));
  for (const BodyPart& part : body.parts) EXPECT_GE(count(legend, part.colour), 100) << part.name;
}

TEST(DrawLabels, DoublesSmallPictures) {
  const BodyModel body = three_parts();
  const DepthImage depth(320, 240, 3000);
  LabelImage labels(320, 240, kBackground);
  labels(7, 9) = 1;
  const ColourImage picture = draw_labels(labels, depth, body, false);
  ASSERT_EQ(picture.width(), 640);
  ASSERT_EQ(picture.height(), 480);
  EXPECT_EQ(count(picture, body.parts[1].colour), 4);
  EXPECT_EQ(picture(15, 19), body.parts[1].colour);
  // A legend fits any picture, even one that is lower than a line of text.
  const ColourImage tiny = draw_labels(LabelImage(4, 3, kBackground), DepthImage(4, 3, 900), body, true);
  for (const BodyPart& part : body.parts) EXPECT_GE(count(tiny, part.colour), 100) << part.name;
}

TEST(DrawLabels, RefusesLabelsOfAnotherSizeOrBody) {
  const BodyModel body = three_parts();
  EXPECT_THROW(draw_labels(LabelImage(4, 3), DepthImage(3, 4), body, true), Error);
  EXPECT_THAT([&] { draw_labels(LabelImage(4, 3, 3), DepthImage(4, 3), body, true); },
              ThrowsMessage<Error>(HasSubstr("label 3")));
}

TEST(DrawPeople, LeavesColourUntouchedWithoutPeople) {
  Frame frame = plain_frame(640, 480);
  frame.colour(3, 4) = {1, 2, 3};
  EXPECT_EQ(draw_people(frame, {}, three_parts()), frame.colour);
  frame.colour = {};
  EXPECT_EQ(draw_people(frame, {}, three_parts()), draw_depth(frame.depth));
}

TEST(DrawPeople, OutlinesTheMask) {
  const Frame frame = plain_frame(640, 480);
  const BodyModel body = three_parts();
  Person person = person_of(frame, body);
  for (int v = 100; v < 200; ++v)
    for (int u = 300; u < 350; ++u) person.mask(u, v) = 1;
  person.box = {300, 100, 50, 100};
  const ColourImage picture = draw_people(frame, {person}, body);
  const Rgb outline = picture(300, 150);
  EXPECT_EQ(picture(349, 150), outline);
  EXPECT_EQ(picture(320, 199), outline);
  EXPECT_NE(picture(301, 150), outline);
  EXPECT_NE(picture(301, 150), frame.colour(301, 150));  // tinted
  EXPECT_EQ(picture(301, 150), picture(348, 198));
  EXPECT_EQ(picture(299, 150), frame.colour(299, 150));
  EXPECT_EQ(picture(350, 150), frame.colour(350, 150));
  EXPECT_EQ(picture(320, 200), frame.colour(320, 200));
}

TEST(DrawPeople, DrawsPeopleInTheColoursOfTheirNumbers) {
  const Frame frame = plain_frame(640, 480);
  const BodyModel body = three_parts();
  std::vector<Person> people(2, person_of(frame, body));
  people[0].mask(100, 300) = 1;
  people[1].mask(500, 300) = 1;
  const ColourImage unnumbered = draw_people(frame, people, body);
  EXPECT_NE(unnumbered(100, 300), unnumbered(500, 300));
  const ColourImage picture = draw_people(frame, people, body, {4, 3}),
                    later = draw_people(frame, people, body, {3, 4});
  EXPECT_EQ(picture(100, 300), later(500, 300));
  EXPECT_EQ(picture(500, 300), later(100, 300));
  EXPECT_NE(picture(100, 300), later(100, 300));
  EXPECT_THAT([&] { draw_people(frame, people, body, {3}); },
              ThrowsMessage<Error>(HasSubstr("1 numbers for 2 people")));
}

TEST(DrawPeople, DrawsObservedPartsAsDiscsAndPredictedOnesAsRings) {
  const Frame frame = plain_frame(640, 480);
  const BodyModel body = three_parts();
  Person person = person_of(frame, body);
  put(person, frame, 0, 200.F, 200.F, State::observed);
  put(person, frame, 2, 400.F, 300.F, State::predicted);  // not linked to part 0, so no line goes through its centre
  const ColourImage picture = draw_people(frame, {person}, body);
  EXPECT_EQ(picture(200, 200), body.parts[0].colour);
  EXPECT_EQ(picture(400, 300), frame.colour(400, 300));
  EXPECT_GT(count(picture, body.parts[0].colour), 20);
  const auto bluish = std::count_if(picture.begin(), picture.end(), [](Rgb c) { return c.b > 120 && c.r < 90; });
  EXPECT_GT(bluish, 8);
}

TEST(DrawPeople, LinksOnlyPartsThatArePresent) {
  const Frame frame = plain_frame(640, 480);
  const BodyModel body = three_parts();
  Person person = person_of(frame, body);
  put(person, frame, 0, 200.F, 200.F, State::observed);
  put(person, frame, 1, 300.F, 200.F, State::observed);
  const auto lit = [](const ColourImage& picture) {
    int rows = 0;
    for (int v = 180; v < 220; ++v) rows += picture(250, v).r > 170 ? 1 : 0;
    return rows;
  };
  const int observed = lit(draw_people(frame, {person}, body));
  EXPECT_GE(observed, 2);
  person.skeleton.parts[1].state = State::predicted;
  const int predicted = lit(draw_people(frame, {person}, body));
  EXPECT_GE(predicted, 1);
  EXPECT_LT(predicted, observed);
  person.skeleton.parts[1].state = State::none;
  EXPECT_EQ(lit(draw_people(frame, {person}, body)), 0);
}

TEST(DrawPeople, DoublesSmallFramesWithTheirSkeletons) {
  const Frame frame = plain_frame(320, 240);
  const BodyModel body = three_parts();
  Person person = person_of(frame, body);
  person.box = {100, 50, 10, 10};
  put(person, frame, 1, 200.F, 150.F, State::observed);
  const ColourImage picture = draw_people(frame, {person}, body);
  ASSERT_EQ(picture.width(), 640);
  ASSERT_EQ(picture.height(), 480);
  EXPECT_EQ(picture(400, 300), body.parts[1].colour);
}

TEST(DrawPeople, LeavesOutPartsWhoseCentreIsNotInView) {
  const Frame frame = plain_frame(64, 48);
  const BodyModel body = three_parts();
  Person person = person_of(frame, body);
  person.box = {-4000, 4000, 1, 1};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Eigen::Vector3f& centre :
       {Eigen::Vector3f(nan, nan, nan), Eigen::Vector3f(0.F, 0.F, 0.F), Eigen::Vector3f(0.F, 0.F, -1.F),
        Eigen::Vector3f(1e30F, 1.F, 1.F), Eigen::Vector3f(1.F, -1.F, 1e-30F)}) {
    for (SkeletonPart& part : person.skeleton.parts) part = {.state = State::observed, .centre = centre};
    const ColourImage picture = draw_people(frame, {person}, body);
    for (const BodyPart& part : body.parts) EXPECT_EQ(count(picture, part.colour), 0);
  }
}

TEST(DrawPeople, RefusesMasksAndSkeletonsThatDoNotFit) {
  const Frame frame = plain_frame(64, 48);
  const BodyModel body = three_parts();
  Person person = person_of(frame, body);
  person.mask = Mask(48, 64);
  EXPECT_THAT([&] { draw_people(frame, {person}, body); }, ThrowsMessage<Error>(HasSubstr("mask of 48x64")));
  person = person_of(frame, body);
  person.skeleton.parts.pop_back();
  EXPECT_THAT([&] { draw_people(frame, {person}, body); }, ThrowsMessage<Error>(HasSubstr("2 parts")));
}

}  // namespace
}  // namespace vesalius
