#include "vesalius/upright.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

constexpr int kWidth = 7, kHeight = 5;

template <class T>
Image<T> random_image(Random& rng) {
  Image<T> image(kWidth, kHeight);
  for (T& value : image) value = static_cast<T>(1 + rng.below(200));
  return image;
}

Frame random_frame() {
  Random rng(1);
  Frame frame{"f", 2.0, {kWidth, kHeight, 6.F, 5.F, 3.25F, 1.5F}, random_image<std::uint16_t>(rng), {}};
  frame.colour = ColourImage(kWidth, kHeight);
  for (Rgb& pixel : frame.colour) pixel = {static_cast<std::uint8_t>(rng.below(256)), 0, 1};
  frame.up = Eigen::Vector3f(0.F, -0.8F, 0.6F);
  return frame;
}

Person random_person(Random& rng) {
  Person person;
  person.mask = random_image<std::uint8_t>(rng);
  person.mask(0, 0) = person.mask(0, 1) = 0;
  person.labels = random_image<std::uint8_t>(rng);
  person.box = bounding_box(person.mask);
  person.skeleton.parts.resize(1);
  person.skeleton.parts[0].centre = {1.F, 2.F, 3.F};
  person.skeleton.voted = {{{1.F, 2.F, 3.F}, 0.1F}};
  person.joints = {{{State::observed, {0.5F, -1.F, 2.F}, 1.F}}};
  person.points = {{{3.F, 1.F, 2.F}, {}, {}}};
  return person;
}

TEST(Upright, TurnedPicturesSeeTheTurnedPoints) {
  const Frame frame = random_frame();
  for (int quarters = 0; quarters < 4; ++quarters) {
    const Frame out = turned(frame, quarters);
    ASSERT_NO_THROW(check(out));
    EXPECT_EQ(out.quarter_turns, 0);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const Eigen::Vector3f point = turned(point_at(frame.camera, frame.depth, u, v), quarters);
        const Eigen::Vector2f to = out.camera.pixel(point);
        const int to_u = int(std::lround(to.x())), to_v = int(std::lround(to.y()));
        ASSERT_NEAR(to.x(), float(to_u), 1e-4F);
        EXPECT_EQ(out.depth(to_u, to_v), frame.depth(u, v)) << quarters;
        EXPECT_EQ(out.colour(to_u, to_v), frame.colour(u, v)) << quarters;
      }
    }
  }
}

TEST(Upright, AClockwiseTurnTakesTheUpperEdgeToTheRight) {
  const Frame frame = random_frame();
  EXPECT_EQ(turned(frame, 1).depth(kHeight - 1, 2), frame.depth(2, 0));
  EXPECT_EQ(turned(Eigen::Vector3f(0.F, -1.F, 0.F), 1), Eigen::Vector3f(1.F, 0.F, 0.F));
}

TEST(Upright, TurningBackGivesWhatWasThere) {
  const Frame frame = random_frame();
  Random rng(3);
  const Detection found{{random_person(rng)}, {{Eigen::Vector3f(0.6F, 0.8F, 0.F), 1.F, 2.F}}};
  Prior prior;
  prior.people.push_back({random_image<std::uint8_t>(rng), {}, 2.F, {{{1.F, 2.F, 3.F}, {3.F, 2.F, 1.F}, 1.F, 1.F}}});
  Trace trace;
  trace.raw_labels = trace.labels = trace.flat = random_image<std::uint8_t>(rng);
  trace.clusters.index = random_image<std::int32_t>(rng);
  trace.clusters.items.resize(1);
  trace.clusters.items[0].first_pixel = 2 * kWidth + 3;
  trace.clusters.items[0].covariance << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  trace.candidates.resize(1);
  trace.candidates[0].grown = trace.flat;
  for (int quarters = 1; quarters < 4; ++quarters) {
    const int back = 4 - quarters;
    const Frame same = turned(turned(frame, quarters), back);
    EXPECT_EQ(same.camera, frame.camera);
    EXPECT_EQ(same.depth, frame.depth);
    EXPECT_EQ(same.colour, frame.colour);
    EXPECT_EQ(*same.up, *frame.up);
    const Detection once = turned(found, quarters), twice = turned(once, back);
    EXPECT_EQ(once.people[0].box.width, quarters == 2 ? kWidth : kHeight);
    EXPECT_EQ(twice.people[0].mask, found.people[0].mask);
    EXPECT_EQ(twice.people[0].labels, found.people[0].labels);
    EXPECT_EQ(twice.people[0].box.u, found.people[0].box.u);
    EXPECT_EQ(twice.people[0].joints[0][0].position, found.people[0].joints[0][0].position);
    EXPECT_EQ(twice.people[0].skeleton.parts[0].centre, found.people[0].skeleton.parts[0].centre);
    EXPECT_EQ(once.people[0].skeleton.voted[0].centre, once.people[0].skeleton.parts[0].centre);
    EXPECT_EQ(twice.people[0].points[0].at, found.people[0].points[0].at);
    EXPECT_EQ(twice.planes[0].normal, found.planes[0].normal);
    const PictureRegion region{{2, 1, 3, 2}, found.planes};
    const PictureRegion lying = turned(region, frame.camera, quarters);
    EXPECT_EQ(crop(turned(frame, quarters).depth, lying.box), turned(cropped(frame, region.box), quarters).depth);
    EXPECT_EQ(lying.planes[0].normal, once.planes[0].normal);
    const Prior known = turned(turned(prior, quarters), back);
    EXPECT_EQ(known.people[0].mask, prior.people[0].mask);
    EXPECT_EQ(known.people[0].flesh[0].to, prior.people[0].flesh[0].to);
    const Trace traced = turned(turned(trace, quarters), back);
    EXPECT_EQ(traced.labels, trace.labels);
    EXPECT_EQ(traced.clusters.index, trace.clusters.index);
    EXPECT_EQ(traced.clusters.items[0].first_pixel, trace.clusters.items[0].first_pixel);
    EXPECT_TRUE(traced.clusters.items[0].covariance.isApprox(trace.clusters.items[0].covariance));
    EXPECT_EQ(traced.candidates[0].grown, trace.candidates[0].grown);
  }
}

TEST(Upright, GravityTellsTheNearestTurnPast60Degrees) {
  Frame frame = random_frame();
  const auto quarters_at = [&](float roll_degrees, float tilt = 0.F) {
    // By so much is the camera turned clockwise about its axis: what is up comes to the left of the picture.
    const float roll = roll_degrees * std::numbers::pi_v<float> / 180.F;
    frame.up = Eigen::Vector3f(-std::sin(roll), -std::cos(roll), tilt).normalized();
    return quarters_to_upright(frame);
  };
  EXPECT_EQ(quarters_at(0.F), 0);
  EXPECT_EQ(quarters_at(55.F), 0);
  EXPECT_EQ(quarters_at(65.F), 1);
  EXPECT_EQ(quarters_at(90.F), 1);
  EXPECT_EQ(quarters_at(-90.F), 3);
  EXPECT_EQ(quarters_at(180.F), 2);
  EXPECT_EQ(quarters_at(90.F, 3.F), 0) << "it looks nearly straight down";
  frame.quarter_turns = 2;
  EXPECT_EQ(quarters_at(0.F), 2) << "what is said counts more";
  EXPECT_EQ(guessed_up(frame), Eigen::Vector3f(0.F, 1.F, 0.F));
  frame.up.reset();
  frame.quarter_turns = 1;
  EXPECT_TRUE(turned(guessed_up(frame), 1).isApprox(-Eigen::Vector3f::UnitY()));
  frame.quarter_turns.reset();
  EXPECT_EQ(quarters_to_upright(frame), 0);
}

}  // namespace
}  // namespace vesalius
