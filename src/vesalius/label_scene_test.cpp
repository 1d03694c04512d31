#include "vesalius/label_scene.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capsule/capsule_person.h"
#include "vesalius/cut_out_labeller.h"
#include "vesalius/error.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/forest/test_headings.h"

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.25F, 131.25F, 79.5F, 59.5F};

/// A labeller that takes every reading for part 3, as a forest without a background class may. It remembers the last
/// picture that it was shown.
class EverythingIsBody : public Labeller {
 public:
  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    shown = depth;
    out = {depth.width(), depth.height(), paper_body().part_count(), 255, {}};
    out.sums.assign(depth.size() * static_cast<std::size_t>(out.classes), 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) out.at(u, v)[3] = depth(u, v) != 0 ? 255 : 0;
    }
  }

  mutable DepthImage shown;
};

class SceneLabellerTest : public testing::Test {
 protected:
  void SetUp() override {
    CapsuleScene scene;
    scene.people.emplace_back();
    scene.boxes.push_back({{-1.2F, 0.3F, 2.F}, {-0.8F, 0.8F, 2.4F}, {}});
    truth = render(scene, kCamera, paper_body());
    labels = labeller.label_scene(truth.frame, clock);
  }

  LabelledFrame truth;
  std::shared_ptr<EverythingIsBody> everything = std::make_shared<EverythingIsBody>();
  SceneLabeller labeller{std::make_shared<CutOutLabeller>(everything, false), {}};
  StageClock clock{nullptr};
  SceneLabels labels;
};

TEST_F(SceneLabellerTest, ShowsNoFlatSurfacesToALabellerWithoutBackground) {
  const LabelImage chosen = labeller.choose(labels, truth.frame, 1.F);
  long flat = 0, rest = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (truth.frame.depth[i] == 0) continue;
    (labels.flat[i] != 0 ? flat : rest) += 1;
    EXPECT_EQ(chosen[i], labels.flat[i] != 0 ? kBackground : 3);
  }
  EXPECT_GT(flat, 5000);
  EXPECT_GT(rest, 500);
}

TEST_F(SceneLabellerTest, ShowsAPersonAloneToALabellerWithoutBackground) {
  Mask person(kCamera.width, kCamera.height, 0);
  long pixels = 0;
  for (std::size_t i = 0; i < person.size(); ++i) pixels += person[i] = truth.person[i] == 0 ? 1 : 0;
  const Box box = bounding_box(person);
  const LabelImage chosen = labeller.label_person(labels, truth.frame, person, box).labels;
  EXPECT_EQ(everything->shown.width(), box.width);
  EXPECT_EQ(std::ranges::count_if(everything->shown, [](std::uint16_t mm) { return mm != 0; }), pixels);
  for (std::size_t i = 0; i < chosen.size(); ++i) ASSERT_EQ(chosen[i], person[i] != 0 ? 3 : kBackground);
}

TEST_F(SceneLabellerTest, KnowsTheFlatSurfacesOfCutOutsForBackground) {
  for (std::size_t i = 0; i < truth.frame.depth.size(); ++i) {
    const int u = static_cast<int>(i) % kCamera.width, v = static_cast<int>(i) / kCamera.width;
    const std::optional<double> share = body_share(labels.smooth, u, v, 25);
    ASSERT_EQ(share.has_value(), truth.frame.depth[i] != 0);
    if (share) {
      ASSERT_EQ(*share, labels.flat[i] != 0 ? 0.0 : 1.0);
    }
  }
}

TEST_F(SceneLabellerTest, GivesTheSameInReusedMemory) {
  SceneLabels other;
  other.flat = Mask(3, 3, 1);
  other.smooth = {.width = 7, .height = 7, .classes = 3, .whole = 510, .sums = std::vector<std::uint16_t>(147, 8)};
  other.smooth.settled = Mask(7, 7, 1);
  const SceneLabels again = labeller.label_scene(truth.frame, clock, std::move(other));
  EXPECT_EQ(again.flat, labels.flat);
  EXPECT_EQ(again.raw.sums, labels.raw.sums);
  EXPECT_EQ(again.smooth.sums, labels.smooth.sums);
}

TEST_F(SceneLabellerTest, LabelsNobodyInAnEmptyMask) {
  const LabelImage nobody(kCamera.width, kCamera.height, kBackground);
  EXPECT_EQ(labeller.label_person(labels, truth.frame, Mask(kCamera.width, kCamera.height, 0), {}).labels, nobody);
}

/// Each pixel by itself, one here and another there, and a wish for a window.
class Speckled : public Labeller {
 public:
  explicit Speckled(int wish) : wish_(wish) {}
  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    out = {depth.width(), depth.height(), paper_body().part_count() + 1, 255, {}};
    out.sums.assign(depth.size() * static_cast<std::size_t>(out.classes), 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) out.at(u, v)[(u * 7 + v * 3) % out.classes] = depth(u, v) != 0 ? 255 : 0;
    }
  }
  int smoothing_window() const override { return wish_; }

 private:
  int wish_;
};

TEST(SmoothingWindow, IsTheLabellersWhereTheOptionsDoNotSay) {
  CapsuleScene scene;
  scene.people.emplace_back();
  const Frame frame = render(scene, kCamera, paper_body()).frame;
  const auto smoothed = [&](int wish, int option) {
    Model model;
    model.body = paper_body();
    model.labeller = std::make_shared<Speckled>(wish);
    StageClock clock{nullptr};
    SceneLabelOptions options;
    options.smooth.window = option;
    return SceneLabeller(model, options).label_scene(frame, clock).smooth.sums;
  };
  const Posteriors raw = Speckled(0).label(frame);
  const auto by_window = [&](int window) {
    return mean_filter(raw, frame.depth, frame.camera, SmoothOptions{.window = window}).sums;
  };
  EXPECT_EQ(smoothed(3, 0), by_window(3));
  EXPECT_EQ(smoothed(3, 7), by_window(7));
  EXPECT_EQ(smoothed(0, 0), by_window(5));
  EXPECT_NE(by_window(3), by_window(5));
}

/// A labeller that finds left and right hands equally likely everywhere: left ones of people seen from the front, right
/// ones of people seen from behind. Its regression takes everybody with a reading at the first pixel for seen from
/// behind.
class CannotTellSides : public Labeller {
 public:
  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    out = test::headed_posteriors(depth);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0) continue;
        out.at(u, v)[l_hand] = sure ? 128 : 64;
        out.at(u, v)[r_hand] = sure ? 127 : 64;
        out.at(u, v)[25] = sure ? 0 : 127;
        out.turns_at(u, v)[8 + 0] = 32768;
        out.turns_at(u, v)[16 + 4] = 32767;
      }
    }
  }

  bool sure = true;  ///< whether it is surely a body
  int l_hand = paper_body().find_part("l_hand");
  int r_hand = paper_body().find_part("r_hand");
};

Model headed(std::shared_ptr<CannotTellSides> labeller) {
  Model model(std::move(labeller));
  model.headings = test::seen_from_behind();
  return model;
}

TEST(SceneLabellerContext, CorrectsTheSmoothedPosteriors) {
  const auto labeller = std::make_shared<CannotTellSides>();
  Model model = headed(labeller);
  Frame frame;
  frame.camera = kCamera;
  frame.depth = DepthImage(kCamera.width, kCamera.height, 2000);
  StageClock clock(nullptr);
  EXPECT_EQ(SceneLabeller(model, {}).label_scene(frame, clock).posteriors().at(50, 50)[25], 0);
  constexpr float kUnlikely = -3.F;
  labeller->sure = false;
  model.context = {BodySurroundings::feature_count(paper_body()), kUnlikely, {BoostedTree{}}};
  const SceneLabels labels = SceneLabeller(model, {}).label_scene(frame, clock);
  EXPECT_NEAR(*body_share(labels.posteriors(), 50, 50, 25), 1.0 / (1.0 + std::exp(3.0)), 0.01);
  EXPECT_NEAR(*body_share(labels.raw, 50, 50, 25), 0.5, 0.01) << "what the forest itself said stays known";

  model.context.features -= 1;
  EXPECT_THAT([&] { SceneLabeller(model, {}); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("context of bodies knows")));
}

TEST(SceneLabellerFacing, LabelsAPersonsPixelsByTheHeadingOfTheWholePerson) {
  const auto labeller = std::make_shared<CannotTellSides>();
  const SceneLabeller scene_labeller(headed(labeller), {});
  Frame frame;
  frame.camera = kCamera;
  frame.depth = DepthImage(kCamera.width, kCamera.height, 2000);
  StageClock clock(nullptr);
  const SceneLabels labels = scene_labeller.label_scene(frame, clock);
  EXPECT_EQ(scene_labeller.choose(labels, frame, 1.F)(50, 50), labeller->l_hand) << "a pixel alone is in doubt";
  Mask person(kCamera.width, kCamera.height, 0);
  const Box box{40, 30, 20, 40};
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) person(box.u + u, box.v + v) = 1;
  }
  const LabelImage inside = scene_labeller.label_person(labels, frame, person, box).labels;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      EXPECT_EQ(inside(u, v), person(u, v) != 0 ? labeller->r_hand : kBackground);
    }
  }
}

TEST(MeanCertainty, IsTheLikeliestPartsShareOfAllParts) {
  Posteriors posteriors{4, 1, 26, 255, std::vector<std::uint16_t>(std::size_t{4} * 26, 0)};
  for (int u = 0; u < 4; ++u) {
    posteriors.at(u, 0)[3] = 50;
    posteriors.at(u, 0)[7] = u < 2 ? 150 : 50;  // 0.75 and 0.5
    posteriors.at(u, 0)[25] = 200;              // the background is ignored
  }
  Mask inside(4, 1, 1);
  EXPECT_FLOAT_EQ(mean_certainty(posteriors, inside, 25), 0.625F);
  posteriors.at(0, 0)[3] = posteriors.at(0, 0)[7] = 0;  // surely background
  inside(3, 0) = 0;
  EXPECT_FLOAT_EQ(mean_certainty(posteriors, inside, 25), 0.625F);
  EXPECT_FLOAT_EQ(mean_certainty(posteriors, Mask(4, 1, 0), 25), 0.F);
}

}  // namespace
}  // namespace vesalius
