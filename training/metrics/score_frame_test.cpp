#include "metrics/score_frame.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "capsule/capsule_person.h"
#include "metrics/match_people.h"
#include "metrics/test_terms.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using ::testing::_;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::ThrowsMessage;

const Camera kCamera{160, 120, 131.25F, 131.25F, 79.5F, 59.5F};

/// A labeller that gives every pixel its true label. With its mistake, the people's pixels in the picture's left half
/// become background.
class Labeller : public vesalius::Labeller {
 public:
  Labeller(LabelImage truth, bool half_blind) : truth_(std::move(truth)), half_blind_(half_blind) {}

  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    ++asked;
    out = {depth.width(), depth.height(), paper_body().part_count() + 1, 255, {}};
    out.sums.assign(depth.size() * out.classes, 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        const std::uint8_t label = truth_(u, v);
        if (depth(u, v) == 0) continue;
        const bool blind = half_blind_ && u < depth.width() / 2;
        if (label != kBackground) out.at(u, v)[label] = blind ? 100 : 155;
        out.at(u, v)[paper_body().part_count()] = label == kBackground || blind ? 120 : 0;
      }
    }
  }

  mutable std::atomic<int> asked = 0;  ///< number of calls

 private:
  LabelImage truth_;
  bool half_blind_;
};

/// Returns a frame with the truth of a labelled dataset under names of joints that the body has.
TrueFrame labelled(const std::vector<float>& people_x_m) {
  CapsuleScene scene;
  scene.wall_z_m = 4.F;
  for (const float x_m : people_x_m) {
    scene.people.emplace_back();
    scene.people.back().feet = {x_m, 1.F, 2.6F};
    scene.people.back().pose.l_arm.raise = 0.9F;
  }
  LabelledFrame rendered = render(scene, kCamera, paper_body());
  TrueFrame frame;
  frame.frame = std::move(rendered.frame);
  frame.truth.people = static_cast<int>(people_x_m.size());
  frame.truth.labels = std::move(rendered.labels);
  frame.truth.person = std::move(rendered.person);
  frame.truth.mask = Mask(kCamera.width, kCamera.height, 0);
  std::ranges::transform(frame.truth.person, frame.truth.mask.begin(),
                         [](std::uint8_t who) -> std::uint8_t { return who == kBackground ? 0 : 1; });
  frame.truth.joint_names = {"neck", "l_elbow", "r_hand"};
  for (const auto& parts : rendered.parts) {
    std::vector<Eigen::Vector3f>& joints = frame.truth.joints.emplace_back();
    for (const char* part : {"neck", "l_elbow", "r_hand"}) {
      joints.push_back(parts[paper_body().find_part(part)]);
    }
  }
  return frame;
}

FrameScorer scorer(const TrueFrame& frame, bool half_blind, bool labels_only = false) {
  FrameScorer::Options options;
  options.detect.label.background_weight = 1.F;
  options.labels_only = labels_only;
  return FrameScorer(std::make_shared<Labeller>(frame.truth.labels, half_blind), options);
}

double value(const FrameScore& score, const std::string& name) { return test::value_of(score.terms, name); }

TEST(FrameScorer, GivesPerfectMetricsForPerfectLabels) {
  const TrueFrame frame = labelled({0.F});
  const FrameScore score = scorer(frame, false).score(frame, false);
  EXPECT_EQ(score.expected, 1);
  EXPECT_DOUBLE_EQ(value(score, "people.found"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "people.false"), 0.0);
  EXPECT_GT(value(score, "mask.iou"), 0.95);
  EXPECT_GT(value(score, "pixels.person_iou"), 0.95);
  EXPECT_GT(value(score, "pixels.recall.l_chest"), 0.9);
  EXPECT_DOUBLE_EQ(value(score, "part.seen.neck"), 1.0);
  EXPECT_GT(value(score, "parts.right"), 0.8);
  EXPECT_DOUBLE_EQ(value(score, "part.right_of_8.neck"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "joints.at_10cm"), 1.0);
  EXPECT_LT(value(score, "joints.error_m"), 0.06);
  EXPECT_THAT(score.joint_precision.averages(),
              ElementsAre(Pair("neck", 1.0), Pair("l_elbow", 1.0), Pair("r_hand", 1.0)));
  EXPECT_THAT(score.what_went_wrong, IsEmpty());
  ASSERT_EQ(score.proposals.size(), 1U);
  EXPECT_TRUE(score.proposals[0].person);
  EXPECT_GT(score.proposals[0].counts.right, 15);
}

TEST(FrameScorer, JudgesAGridOnTheWholePicture) {
  const TrueFrame frame = labelled({0.F});
  FrameScorer::Options options;
  options.detect.grid.step = 2;
  options.detect.cluster.min_pixels = 3;
  const FrameScorer half(std::make_shared<Labeller>(every_nth(frame.truth.labels, 2), false), options);
  const FrameScore score = half.score(frame, false);
  EXPECT_DOUBLE_EQ(value(score, "people.found"), 1.0);
  ASSERT_EQ(score.people.size(), 1U);
  EXPECT_TRUE(score.people[0].mask.same_size(frame.frame.depth));
  EXPECT_TRUE(score.labels.same_size(frame.frame.depth));
  EXPECT_GT(value(score, "pixels.person_iou"), 0.9);
  EXPECT_GT(value(score, "mask.iou"), 0.85);  // thin limbs are few pixels
  EXPECT_LT(value(score, "joints.error_m"), 0.08);
  options.labels_only = true;
  const FrameScorer quick(std::make_shared<Labeller>(every_nth(frame.truth.labels, 2), false), options);
  EXPECT_EQ(quick.score(frame, false).labels, score.labels);
}

TEST(FrameScorer, GivesLowerIouAndRecallForWrongLabels) {
  const TrueFrame frame = labelled({0.F});
  const FrameScore score = scorer(frame, true).score(frame, false);
  EXPECT_LT(value(score, "pixels.person_iou"), 0.6);
  EXPECT_GT(value(score, "pixels.person_iou"), 0.4);
  EXPECT_LT(value(score, "pixels.recall.r_upper_arm"), 0.1);         // at the left of the picture
  EXPECT_GT(value(score, "pixels.recall_inside.r_upper_arm"), 0.9);  // but it is the best of the parts
  EXPECT_GT(value(score, "pixels.recall.l_upper_arm"), 0.9);
}

TEST(FrameScorer, CountsMissedAndSurplusPeople) {
  TrueFrame frame = labelled({-0.7F, 0.7F});
  const FrameScorer both = scorer(frame, false);
  EXPECT_DOUBLE_EQ(value(both.score(frame, false), "people.found"), 1.0);
  TrueFrame blind = frame;
  for (std::size_t i = 0; i < blind.truth.labels.size(); ++i) {
    if (blind.truth.person[i] == 1) blind.truth.labels[i] = kBackground;
  }
  const FrameScore missed = scorer(blind, false).score(frame, false);
  EXPECT_DOUBLE_EQ(value(missed, "people.found"), 0.5);
  EXPECT_DOUBLE_EQ(value(missed, "part.seen.neck"), 0.5);
  EXPECT_DOUBLE_EQ(value(missed, "part.right_of_8.neck"), 1.0);  // of whoever is found
  EXPECT_DOUBLE_EQ(value(missed, "joints.at_10cm"), 0.5);
  EXPECT_THAT(missed.joint_precision.averages(), Each(Pair(_, 0.5)));
  EXPECT_THAT(missed.what_went_wrong, HasSubstr("1 of 2 people missed"));
  EXPECT_GE(missed.badness, 1.0);
  frame.truth = {};
  frame.truth.people = 0;
  const FrameScore surplus = both.score(frame, false);
  EXPECT_DOUBLE_EQ(value(surplus, "people.false"), 2.0);
  EXPECT_DOUBLE_EQ(value(surplus, "frames.empty_with_person"), 1.0);
  EXPECT_GT(value(surplus, "pixels.body_on_empty"), 0.02);
  EXPECT_THAT(surplus.what_went_wrong, HasSubstr("2 found who are none"));
}

TEST(FrameScorer, FitsJointsInsteadOfScoringThem) {
  const TrueFrame frame = labelled({0.F});
  const FrameScore score = scorer(frame, false).score(frame, true);
  EXPECT_TRUE(std::isnan(value(score, "joints.at_10cm")));
  EXPECT_THAT(score.joint_precision.averages(), IsEmpty());
  ASSERT_EQ(score.known_people.size(), 1U);
  const KnownPerson& person = score.known_people[0];
  EXPECT_EQ(person.joint_set, "nite15");  // joints that are not those of a rendered skeleton
  EXPECT_EQ(person.joint_names, frame.truth.joint_names);
  const Eigen::Vector3f neck = person.skeleton.parts[paper_body().find_part("neck")].centre;
  EXPECT_GT(person.joints[0].norm(), neck.norm());  // the middle of a part is behind its surface
  EXPECT_LT((person.joints[0] - neck).norm(), 0.15F);
  EXPECT_THAT(person.part_centres, IsEmpty());
}

TEST(FrameScorer, ComparesJointsWithTheSetAskedFor) {
  const TrueFrame frame = labelled({0.F});
  FrameScorer::Options options;
  options.detect.label.background_weight = 1.F;
  options.joint_set = "k4abt32";
  const auto labeller = std::make_shared<Labeller>(frame.truth.labels, false);
  const FrameScore fitted = FrameScorer(labeller, options).score(frame, true);
  ASSERT_EQ(fitted.known_people.size(), 1U);
  EXPECT_EQ(fitted.known_people[0].joint_set, "k4abt32");
  EXPECT_DOUBLE_EQ(value(FrameScorer(labeller, options).score(frame, false), "joints.at_10cm"), 1.0);
  options.joint_set = "kinect99";
  EXPECT_THAT([&] { FrameScorer(labeller, options); },
              ThrowsMessage<UsageError>(HasSubstr("joint set \"kinect99\", expected one of nite15, k4abt32")));
}

TEST(FrameScorer, GivesTheDetectorsLabelsWithLabelsOnly) {
  const TrueFrame frame = labelled({0.F});
  const FrameScore quick = scorer(frame, true, true).score(frame, false);
  const FrameScore whole = scorer(frame, true).score(frame, false);
  EXPECT_EQ(quick.labels, whole.labels);
  EXPECT_DOUBLE_EQ(value(quick, "pixels.person_iou"), value(whole, "pixels.person_iou"));
  EXPECT_TRUE(std::isnan(value(quick, "people.found")));
  EXPECT_THAT(quick.what_went_wrong, HasSubstr("pixel IoU"));
}

TEST(FrameScorer, LabelsEachFrameOnce) {
  const TrueFrame frame = labelled({0.F});
  for (const bool labels_only : {false, true}) {
    const auto labeller = std::make_shared<Labeller>(frame.truth.labels, false);
    FrameScorer::Options options;
    options.labels_only = labels_only;
    FrameScorer(labeller, options).score(frame, false);
    EXPECT_EQ(labeller->asked, 1);
  }
}

TEST(FrameScorer, RefusesTruthThatDoesNotFit) {
  const TrueFrame frame = labelled({0.F});
  const FrameScorer score = scorer(frame, false);
  TrueFrame other = frame;
  other.truth.mask = Mask(10, 10, 0);
  EXPECT_THAT([&] { score.score(other, false); },
              ThrowsMessage<Error>(HasSubstr("another size than the depth, 160x120")));
  other = frame;
  other.truth.joints[0].pop_back();
  EXPECT_THAT([&] { score.score(other, false); }, ThrowsMessage<Error>(HasSubstr("2 joints, expected 3")));
  other = frame;
  other.truth.person = {};
  EXPECT_THAT([&] { score.score(other, false); }, ThrowsMessage<Error>(HasSubstr("labels without the persons")));
}

}  // namespace
}  // namespace vesalius
