#include "vesalius/forest/label_scene.h"

#include <gmock/gmock.h>

#include "capsule/capsule_person.h"

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.25F, 131.25F, 79.5F, 59.5F};

/// A labeller that takes every reading for part 3, as a forest without background class may. It remembers the last
/// picture that it was shown.
class EverythingIsBody : public PixelLabeller {
 public:
  void label_into(const DepthImage& depth, const Camera& /*camera*/, float /*gate*/, Posteriors& out) const override {
    shown = depth;
    out = {depth.width(), depth.height(), paper_body().part_count(), 1, {}};
    out.sums.assign(depth.size() * static_cast<std::size_t>(out.classes), 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) out.at(u, v)[3] = depth(u, v) != 0 ? 255 : 0;
    }
  }
  const BodyModel& body() const override { return paper_body(); }
  bool has_background() const override { return false; }
  bool has_distributions() const override { return true; }

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
  SceneLabeller labeller{everything, {}};
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
  const LabelImage chosen = labeller.label_person(labels, truth.frame, person, box);
  EXPECT_EQ(everything->shown.width(), box.width);
  EXPECT_EQ(std::ranges::count_if(everything->shown, [](std::uint16_t mm) { return mm != 0; }), pixels);
  for (std::size_t i = 0; i < chosen.size(); ++i) ASSERT_EQ(chosen[i], person[i] != 0 ? 3 : kBackground);
}

TEST_F(SceneLabellerTest, GivesTheSameInReusedMemory) {
  SceneLabels other;
  other.flat = Mask(3, 3, 1);
  other.shown = DepthImage(5, 5, 9);
  other.smooth = {7, 7, 3, 2, std::vector<std::uint16_t>(147, 8), Mask(7, 7, 1)};
  const SceneLabels again = labeller.label_scene(truth.frame, clock, std::move(other));
  EXPECT_EQ(again.flat, labels.flat);
  EXPECT_EQ(again.shown, labels.shown);
  EXPECT_EQ(again.raw.sums, labels.raw.sums);
  EXPECT_EQ(again.smooth.sums, labels.smooth.sums);
}

TEST_F(SceneLabellerTest, LabelsNobodyInAnEmptyMask) {
  const LabelImage nobody(kCamera.width, kCamera.height, kBackground);
  EXPECT_EQ(labeller.label_person(labels, truth.frame, Mask(kCamera.width, kCamera.height, 0), {}), nobody);
}

}  // namespace
}  // namespace vesalius
