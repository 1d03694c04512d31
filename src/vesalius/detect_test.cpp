#include "vesalius/detect.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "capsule/capsule_person.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/cut_out_labeller.h"
#include "vesalius/default_judge.h"
#include "vesalius/error.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/forest/test_headings.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/prior.h"
#include "vesalius/score_person.h"
#include "vesalius/trace.h"
#include "vesalius/upright.h"

namespace vesalius {
namespace {

const Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

/// A labeller that knows the truth. It shows what the stages after labelling make of perfect labels.
class TruthLabeller : public Labeller {
 public:
  TruthLabeller(LabelImage truth, BodyModel body, bool background)
      : truth_(std::move(truth)), body_(std::move(body)), background_(background) {}

  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    const Camera& camera = frame.camera;
    out = {depth.width(), depth.height(), body_.part_count() + (background_ ? 1 : 0), 255, {}};
    out.sums.assign(depth.size() * static_cast<std::size_t>(out.classes), 0);
    // The second pass shows a part of the picture. Its principal point tells which one.
    const int left = static_cast<int>(std::lround(kCamera.cx - camera.cx));
    const int top = static_cast<int>(std::lround(kCamera.cy - camera.cy));
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        const std::uint8_t label = truth_(left + u, top + v);
        if (depth(u, v) == 0) continue;
        if (label != kBackground) {
          out.at(u, v)[label] = 255;
        } else if (background_) {
          out.at(u, v)[body_.part_count()] = 255;
        }
      }
    }
  }

 private:
  LabelImage truth_;
  BodyModel body_;
  bool background_;
};

/// Returns a model that knows the truth, with a background class or of cut-outs.
Model truth_model(const LabelImage& truth, const BodyModel& body, bool background) {
  std::shared_ptr<const Labeller> labeller = std::make_shared<TruthLabeller>(truth, body, background);
  if (background) return {labeller, body};
  Model model(std::make_shared<CutOutLabeller>(labeller, true), body);
  model.judge = default_judge_of_cut_outs();
  return model;
}

/// A judge with these log odds for whatever has no more, and more, than `least` of a kind of evidence.
BoostedTrees judge_by(int feature, float least, float below = -9.F, float above = 9.F) {
  BoostedTrees judge{int(judge_names(paper_body()).size()), 0.F, std::vector<BoostedTree>(1),
                     judge_names(paper_body())};
  BoostedTree& tree = judge.trees.front();
  tree.threshold.fill(std::numeric_limits<float>::infinity());
  tree.feature[0] = static_cast<std::uint16_t>(feature);
  tree.threshold[0] = least;
  tree.value.fill(below);
  tree.value[BoostedTree::kLeaves / 2] = above;
  return judge;
}

CapsuleScene one_person(float z_m) {
  CapsuleScene scene;
  scene.people.emplace_back();
  // A near camera must be higher to have the head in view.
  scene.floor_y_m = z_m < 1.5F ? 1.3F : 0.9F;
  scene.people[0].feet = {0.1F, scene.floor_y_m, z_m};
  scene.people[0].pose.l_arm.raise = 0.9F;
  scene.people[0].pose.r_arm.forward = 0.4F;
  scene.wall_z_m = z_m + 1.2F;
  return scene;
}

std::vector<Person> detect_truth(const LabelledFrame& truth, bool background, const BodyModel& body = paper_body(),
                                 const DetectOptions& options = {}, Trace* trace = nullptr) {
  const Detector detector(truth_model(truth.labels, body, background), options);
  return detector.detect(truth.frame, trace);
}

/// Returns the mean of the part's visible surface on person `who`, and its number of pixels.
std::pair<Eigen::Vector3f, int> visible_centre(const LabelledFrame& truth, int who, int part) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int n = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      if (truth.person(u, v) != who || truth.labels(u, v) != part) continue;
      sum +=
          kCamera
              .point(static_cast<float>(u), static_cast<float>(v), static_cast<float>(truth.frame.depth(u, v)) * 1e-3F)
              .cast<double>();
      ++n;
    }
  }
  return {(sum / std::max(1, n)).cast<float>(), n};
}

class Distances : public testing::TestWithParam<std::tuple<float, bool>> {};

TEST_P(Distances, EveryVisiblePartIsWithinFourCentimetres) {
  const auto [z, background] = GetParam();
  const LabelledFrame truth = render(one_person(z), kCamera, paper_body());
  const std::vector<Person> people = detect_truth(truth, background);
  ASSERT_EQ(people.size(), 1U);
  int visible = 0;
  for (int part = 0; part < paper_body().part_count(); ++part) {
    const auto [centre, pixels] = visible_centre(truth, 0, part);
    const float area_cm2 = static_cast<float>(pixels) * z * z / (262.5F * 262.5F) * 1e4F;
    if (pixels < 25 || area_cm2 < 25.F) continue;
    // Without a background class the floor is removed first, and at 4 m everything lower than 7 cm with it.
    if (!background && z > 3.5F && paper_body().parts[part].name.ends_with("foot")) continue;
    ++visible;
    const SkeletonPart& found = people[0].skeleton.parts[part];
    EXPECT_EQ(found.state, State::observed) << paper_body().parts[part].name;
    EXPECT_LT((found.centre - centre).norm(), 0.04F) << paper_body().parts[part].name;
  }
  EXPECT_GE(visible, z < 1.5F ? 10 : 18);
}

INSTANTIATE_TEST_SUITE_P(OneToFourMetres, Distances,
                         testing::Combine(testing::Values(1.4F, 2.F, 3.F, 4.F), testing::Bool()));

TEST(Detector, FindsThreePeopleAndTheirMasks) {
  CapsuleScene scene = one_person(2.5F);
  scene.people.resize(3, scene.people[0]);
  scene.people[1].feet = {-0.7F, 0.9F, 2.9F};
  scene.people[1].pose = {};
  scene.people[2].feet = {0.95F, 0.9F, 3.1F};
  scene.people[2].pose.yaw = 0.5F;
  const LabelledFrame truth = render(scene, kCamera, paper_body());
  const std::vector<Person> people = detect_truth(truth, true);
  ASSERT_EQ(people.size(), 3U);
  const auto map = body_index_map(people, kCamera.width, kCamera.height);
  for (int found = 0; found < 3; ++found) {
    std::array<long, 3> overlap{};
    long all = 0;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (map[i] != found) continue;
      ++all;
      if (truth.person[i] != kBackground) ++overlap[truth.person[i]];
    }
    EXPECT_GT(*std::ranges::max_element(overlap), 0.95 * static_cast<double>(all)) << "person " << found;
  }
  EXPECT_GE(people[0].score, people[1].score);
  EXPECT_GE(people[1].score, people[2].score);
}

TEST(Detector, FindsTheSamePeopleWithATurnedCameraInItsOwnFrame) {
  const LabelledFrame truth = render(one_person(2.5F), kCamera, paper_body());
  const Detector detector(truth_model(truth.labels, paper_body(), true));
  Trace upright_trace, trace;
  const std::vector<Person> upright = detector.detect(truth.frame, &upright_trace);
  ASSERT_EQ(upright.size(), 1U);
  for (int quarters = 1; quarters < 4; ++quarters) {
    Frame frame = turned(truth.frame, 4 - quarters);
    frame.quarter_turns = quarters;
    const Mask expected = turned(upright[0].mask, 4 - quarters);
    Prior prior;
    prior.people.push_back({expected, {}, 2.F});
    const std::vector<Person> people = detector.detect(frame, prior, &trace);
    ASSERT_EQ(people.size(), 1U) << quarters;
    EXPECT_EQ(people[0].mask, expected);
    EXPECT_EQ(people[0].labels, turned(upright[0].labels, 4 - quarters));
    EXPECT_EQ(people[0].score, upright[0].score);
    for (std::size_t p = 0; p < upright[0].skeleton.parts.size(); ++p) {
      EXPECT_EQ(people[0].skeleton.parts[p].centre, turned(upright[0].skeleton.parts[p].centre, 4 - quarters)) << p;
    }
    EXPECT_EQ(trace.labels, turned(upright_trace.labels, 4 - quarters));
    EXPECT_EQ(detector.label(frame).labels, trace.labels);
  }
}

TEST(Detector, FindsNobodyInAnEmptyRoom) {
  CapsuleScene scene = one_person(2.5F);
  scene.people.clear();
  scene.boxes.push_back({{-1.F, 0.2F, 2.F}, {0.F, 0.9F, 2.6F}, {}});
  const LabelledFrame truth = render(scene, kCamera, paper_body());
  EXPECT_TRUE(detect_truth(truth, true).empty());
  EXPECT_TRUE(detect_truth(truth, false).empty());
}

TEST(Detector, WorksWithoutColour) {
  LabelledFrame truth = render(one_person(2.5F), kCamera, paper_body());
  truth.frame.colour = {};
  EXPECT_EQ(detect_truth(truth, true).size(), 1U);
}

TEST(Detector, GivesAPersonConsistentMaskLabelsBoxAndScore) {
  const LabelledFrame truth = render(one_person(2.5F), kCamera, paper_body());
  Trace trace;
  const std::vector<Person> people = detect_truth(truth, false, paper_body(), {}, &trace);
  ASSERT_EQ(people.size(), 1U);
  const Person& p = people[0];
  EXPECT_EQ(p.joints.size(), paper_body().joint_sets.size());
  int left = kCamera.width, bottom = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      if (p.mask(u, v) == 0) {
        EXPECT_EQ(p.labels(u, v), kBackground);
        continue;
      }
      left = std::min(left, u);
      bottom = v;
    }
  }
  EXPECT_EQ(p.box.u, left);
  EXPECT_EQ(p.box.v + p.box.height - 1, bottom);
  EXPECT_GT(p.score, 0.5F);
  EXPECT_LE(p.score, 1.F);
  ASSERT_FALSE(trace.candidates.empty());
  EXPECT_TRUE(trace.candidates[0].accepted);
  EXPECT_EQ(trace.labels.width(), kCamera.width);
  EXPECT_EQ(trace.raw_labels.width(), kCamera.width);
}

TEST(Detector, ReturnsTheRoughSkeletonWithoutSecondPass) {
  const LabelledFrame truth = render(one_person(2.5F), kCamera, paper_body());
  DetectOptions options;
  options.refine.second_pass = false;
  Trace trace;
  const std::vector<Person> people = detect_truth(truth, true, paper_body(), options, &trace);
  ASSERT_EQ(people.size(), 1U);
  EXPECT_EQ(people[0].skeleton.score, trace.rough[0].score);
  options.refine.min_parts = 26;
  EXPECT_TRUE(detect_truth(truth, true, paper_body(), options).empty());
}

/// Returns a body of twelve parts above the waist, as a user would write it.
BodyModel upper_body() {
  const std::vector<std::string> names{"neck",   "l_face_top",  "r_face_top",  "l_chest",   "r_chest",   "l_hips",
                                       "r_hips", "l_upper_arm", "r_upper_arm", "l_forearm", "r_forearm", "l_hand"};
  std::ostringstream toml;
  toml << "name = \"upper12\"\nroots = [\"neck\"]\n";
  for (const std::string& n : names) {
    std::string other = n;
    other[0] = n[0] == 'l' ? 'r' : 'l';
    const bool paired = std::ranges::find(names, other) != names.end();
    toml << "[[part]]\nname = \"" << n << "\"\ncolour = [10, 20, 30]\nmirror = \"" << (paired ? other : n)
         << "\"\nmax_extent = 0.9\narea = 0.02\nupper_body = true\n";
  }
  const auto link = [&](const char* a, const char* b, double length) {
    toml << "[[link]]\nparent = \"" << a << "\"\nchild = \"" << b << "\"\nlength = " << length
         << "\ntolerance = 0.12\n";
  };
  link("neck", "l_face_top", 0.2);
  link("neck", "r_face_top", 0.2);
  link("neck", "l_chest", 0.18);
  link("neck", "r_chest", 0.18);
  link("l_chest", "l_hips", 0.3);
  link("r_chest", "r_hips", 0.3);
  link("l_chest", "l_upper_arm", 0.18);
  link("r_chest", "r_upper_arm", 0.18);
  link("l_upper_arm", "l_forearm", 0.25);
  link("r_upper_arm", "r_forearm", 0.25);
  link("l_forearm", "l_hand", 0.2);
  return parse_body_model(toml.str(), "upper12");
}

TEST(Detector, TakesAnotherBodyWithoutRecompiling) {
  const BodyModel body = upper_body();
  ASSERT_EQ(body.part_count(), 12);
  const LabelledFrame truth = render(one_person(2.2F), kCamera, body);
  const std::vector<Person> people = detect_truth(truth, true, body);
  ASSERT_EQ(people.size(), 1U);
  EXPECT_GE(people[0].skeleton.found, 10);
  EXPECT_TRUE(people[0].joints.empty());
}

void expect_same(const std::vector<Person>& a, const std::vector<Person>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].mask, b[i].mask);
    EXPECT_EQ(a[i].labels, b[i].labels);
    EXPECT_EQ(a[i].score, b[i].score);
    for (std::size_t k = 0; k < a[i].skeleton.parts.size(); ++k) {
      EXPECT_EQ(a[i].skeleton.parts[k].centre, b[i].skeleton.parts[k].centre);
    }
  }
}

// Labels: threads
TEST(Detector, GivesTheSameResultForAnyNumberOfThreadsAndEveryTime) {
  CapsuleScene scene = one_person(2.5F);
  scene.people.push_back(scene.people[0]);
  scene.people[1].feet.x() = -0.8F;
  LabelledFrame truth = render(scene, kCamera, paper_body());
  add_sensor_noise(truth.frame, 2);
  std::vector<std::vector<Person>> results;
  for_threads({1, 2, 8, 8}, [&] { results.push_back(detect_truth(truth, false)); });
  ASSERT_EQ(results[0].size(), 2U);
  for (std::size_t i = 1; i < results.size(); ++i) expect_same(results[0], results[i]);
}

TEST(Detector, LooksAtAGridOfLargePicturesAndLabelsAllPixels) {
  const Camera large{640, 480, 525.F, 525.F, 319.F, 239.F};  // every second pixel is kCamera's
  const LabelledFrame truth = render(one_person(2.F), large, paper_body());
  const Detector detector(std::make_shared<TruthLabeller>(every_nth(truth.labels, 2), paper_body(), true));
  Trace trace;
  StageTimes times;
  const std::vector<Person> people = detector.detect(truth.frame, &trace, &times);
  const std::vector<Person> coarse = detector.detect(every_nth(truth.frame, 2));
  ASSERT_EQ(people.size(), 1U);
  ASSERT_EQ(coarse.size(), 1U);
  EXPECT_GT(times[Stage::grid], 0.0);
  EXPECT_EQ(people[0].score, coarse[0].score);
  for (std::size_t i = 0; i < coarse[0].skeleton.parts.size(); ++i) {
    EXPECT_EQ(people[0].skeleton.parts[i].centre, coarse[0].skeleton.parts[i].centre);
  }
  EXPECT_EQ(every_nth(people[0].mask, 2), coarse[0].mask);
  EXPECT_EQ(every_nth(people[0].labels, 2), coarse[0].labels);
  long both = 0, either = 0, right = 0;
  for (std::size_t i = 0; i < truth.person.size(); ++i) {
    const bool is = truth.person[i] == 0, found = people[0].mask[i] != 0;
    both += is && found ? 1 : 0;
    either += is || found ? 1 : 0;
    right += is && found && people[0].labels[i] == truth.labels[i] ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(both), 0.95 * static_cast<double>(either));
  EXPECT_GT(static_cast<double>(right), 0.9 * static_cast<double>(both));
  const Box box = bounding_box(people[0].mask);
  EXPECT_EQ(people[0].box.u, box.u);
  EXPECT_EQ(people[0].box.height, box.height);
  for (const Image<std::uint8_t>* picture :
       {&trace.raw_labels, &trace.labels, &trace.flat, &trace.candidates[0].grown, &trace.candidates[0].labels}) {
    EXPECT_TRUE(picture->same_size(truth.frame.depth));
  }
  for (std::size_t i = 0; i < trace.clusters.items.size(); ++i) {
    const auto first = static_cast<std::size_t>(trace.clusters.items[i].first_pixel);
    EXPECT_EQ(trace.clusters.index[first], static_cast<std::int32_t>(i));
  }
}

TEST(Detector, RefusesOptionsOutOfRangeAndFramesOfTwoSizes) {
  const LabelledFrame truth = render(one_person(2.5F), kCamera, paper_body());
  DetectOptions options;
  options.refine.min_score = 1.5F;
  EXPECT_THROW(detect_truth(truth, true, paper_body(), options), UsageError);
  LabelledFrame wrong = truth;
  wrong.frame.camera.width = 100;
  EXPECT_THROW(detect_truth(wrong, true), Error);
  wrong = truth;
  wrong.frame.colour = ColourImage(10, 10);
  EXPECT_THROW(detect_truth(wrong, true), Error);
}

/// A labeller that gives the background more weight than the parts on one person, as a forest does for somebody in
/// unusual clothes.
class DoubtfulLabeller : public TruthLabeller {
 public:
  DoubtfulLabeller(const LabelledFrame& truth, int doubted)
      : TruthLabeller(truth.labels, paper_body(), true), person_(truth.person), doubted_(doubted) {}

  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    TruthLabeller::label_into(frame, gate, out);
    const DepthImage& depth = frame.depth;
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (person_(u, v) != doubted_ || depth(u, v) == 0) continue;
        for (int c = 0; c < out.classes; ++c) out.at(u, v)[c] = static_cast<std::uint16_t>(out.at(u, v)[c] / 4);
        out.at(u, v)[out.classes - 1] = 191;
      }
    }
  }

 private:
  Image<std::uint8_t> person_;
  int doubted_;
};

/// A judge lets pass whom the labeller doubts, with a lower score.
Model lenient(std::shared_ptr<const Labeller> labeller) {
  constexpr int kBody = 4;  // in the order of kJudgedEvidence
  Model model(std::move(labeller));
  model.judge = judge_by(kBody, 0.5F, 2.F, 3.F);
  return model;
}

/// Two people. The labeller doubts the second one.
class DetectorWithPrior : public testing::Test {
 protected:
  void SetUp() override {
    CapsuleScene scene = one_person(2.5F);
    scene.people.push_back(scene.people[0]);
    scene.people[1].feet.x() = -0.8F;
    truth = render(scene, kCamera, paper_body());
    detector = std::make_unique<Detector>(lenient(std::make_shared<DoubtfulLabeller>(truth, 1)), options);
  }

  /// Returns the pixels of a person, moved to the right by some pixels.
  Mask mask_of(int who, int moved = 0) const {
    Mask mask(kCamera.width, kCamera.height, 0);
    for (int v = 0; v < mask.height(); ++v) {
      for (int u = moved; u < mask.width(); ++u) mask(u, v) = truth.person(u - moved, v) == who ? 1 : 0;
    }
    return mask;
  }

  double overlap(const Mask& mask, int who) const {
    long both = 0, either = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      both += mask[i] != 0 && truth.person[i] == who ? 1 : 0;
      either += mask[i] != 0 || truth.person[i] == who ? 1 : 0;
    }
    return static_cast<double>(both) / static_cast<double>(either);
  }

  LabelledFrame truth;
  DetectOptions options;
  std::unique_ptr<Detector> detector;
};

TEST_F(DetectorWithPrior, FindsAPersonWhomTheLabelsLose) {
  const std::vector<Person> alone = detector->detect(truth.frame);
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_GT(overlap(alone[0].mask, 0), 0.9);
  Trace trace;
  const std::vector<Person> people = detector->detect(truth.frame, {{{mask_of(1, 3), {}}}}, &trace);
  ASSERT_EQ(people.size(), 2U);
  EXPECT_GT(overlap(people[0].mask, 0), 0.9);
  EXPECT_GT(overlap(people[1].mask, 1), 0.9);
  expect_same({people[0]}, alone);
  EXPECT_EQ(trace.candidates[1].known, 0);
  EXPECT_TRUE(trace.candidates[1].accepted);
}

TEST_F(DetectorWithPrior, FindsByItsFleshAPersonOfWhomLabelsFindNoParts) {
  // Balls at the points of the person whom the labels lose.
  Prior::KnownPerson known{{}, {}, 20.F};
  const Mask pixels = mask_of(1);
  for (int v = 0; v < pixels.height(); v += 3) {
    for (int u = 0; u < pixels.width(); u += 3) {
      if (pixels(u, v) == 0) continue;
      const Eigen::Vector3f at = point_at(truth.frame.camera, truth.frame.depth, u, v);
      known.flesh.push_back({at, at, 0.03F, 0.03F});
    }
  }
  options.refine.min_parts = 26;  // more than there are
  const Detector strict(lenient(std::make_shared<DoubtfulLabeller>(truth, 1)), options);
  ASSERT_TRUE(strict.detect(truth.frame, {{{mask_of(1), {}, 20.F}}}).empty()) << "a mask alone needs its parts";
  const std::vector<Person> people = strict.detect(truth.frame, {{known}});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_GT(overlap(people[0].mask, 1), 0.75) << "without the rim, where smoothing leaves little body";
  known.odds = 1.F;
  EXPECT_TRUE(strict.detect(truth.frame, {{known}}).empty()) << "and so does a guess";
}

TEST_F(DetectorWithPrior, FindsPeopleOfAForestWithoutBackgroundToo) {
  options.refine.min_score = 1.F;  // nobody is sure enough without the prior
  const Detector without(truth_model(truth.labels, paper_body(), false), options);
  Trace trace;
  EXPECT_TRUE(without.detect(truth.frame, {{{mask_of(0), {}}}}, &trace).empty());
  EXPECT_TRUE(std::ranges::any_of(trace.candidates, [](const auto& c) { return c.known == 0 && c.score > 0.5F; }));
}

TEST_F(DetectorWithPrior, LooksAgainOnlyForWhomItWouldMiss) {
  Trace alone, trace;
  detector->detect(truth.frame, &alone);
  detector->detect(truth.frame, {{{mask_of(0), {}}, {mask_of(1), {}}}}, &trace);
  EXPECT_EQ(trace.candidates.size(), alone.candidates.size() + 1);
  EXPECT_TRUE(std::ranges::any_of(trace.candidates, [](const auto& c) { return c.known == 1; }));
}

TEST_F(DetectorWithPrior, OddsLetALowerScoreSufficeForTheKnownPersonAlone) {
  Trace trace;
  ASSERT_EQ(detector->detect(truth.frame, {{{mask_of(1), {}}}}, &trace).size(), 2U);
  const float sure = trace.candidates[0].score, doubted = trace.candidates[1].score;
  ASSERT_LT(doubted, sure);
  options.refine.min_score = 0.5F * (doubted + sure);
  const Detector strict(lenient(std::make_shared<DoubtfulLabeller>(truth, 1)), options);
  const auto odds = [](float p) { return p / (1.F - p); };
  const float needed = odds(options.refine.min_score) / odds(doubted);
  EXPECT_EQ(strict.detect(truth.frame, {{{mask_of(1), {}, 0.99F * needed}}}).size(), 1U);
  const std::vector<Person> people = strict.detect(truth.frame, {{{mask_of(1), {}, 1.01F * needed}}});
  ASSERT_EQ(people.size(), 2U);
  EXPECT_NEAR(std::min(people[0].score, people[1].score), doubted, 1e-6F) << "the score is the frame's own";
  EXPECT_EQ(strict.detect(truth.frame, {{{mask_of(0), {}, 2.F * needed}}}).size(), 1U) << "somebody else's odds";
}

TEST_F(DetectorWithPrior, LowOddsAskForMore) {
  Trace trace;
  detector->detect(truth.frame, &trace);
  const float score = trace.candidates[0].score;
  ASSERT_LT(score, 1.F);
  const float least = options.refine.min_score / (1.F - options.refine.min_score) * (1.F - score) / score;
  EXPECT_EQ(detector->detect(truth.frame, {{{mask_of(0), {}, 1.01F * least}}}).size(), 1U);
  EXPECT_TRUE(detector->detect(truth.frame, {{{mask_of(0), {}, 0.99F * least}}}).empty());
}

TEST_F(DetectorWithPrior, RefusesOddsAndSizesThatAreNone) {
  for (const float number : {0.F, -1.F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    EXPECT_THAT(
        [&] {
          detector->detect(truth.frame, {{{mask_of(1), {}, number}}});
        },
        testing::ThrowsMessage<Error>(testing::HasSubstr("odds of person 0")));
    EXPECT_THAT(
        [&] {
          detector->detect(truth.frame, {{{mask_of(1), {}, 1.F, {}, number}}});
        },
        testing::ThrowsMessage<Error>(testing::HasSubstr("size of person 0")));
  }
}

TEST(Prior, LinksOfAKnownChildAreExpectedToBeShort) {
  CapsuleScene scene = one_person(2.5F);
  scene.people.push_back(scene.people[0]);
  scene.people[1].feet.x() = -0.9F;
  scene.people[1].build.stature_m = 1.F;
  const LabelledFrame truth = render(scene, kCamera, paper_body());
  const Detector detector(std::make_shared<TruthLabeller>(truth.labels, paper_body(), true));
  Mask child(kCamera.width, kCamera.height, 0);
  for (std::size_t i = 0; i < child.size(); ++i) child[i] = truth.person[i] == 1 ? 1 : 0;
  const auto candidates_for = [&](float size) {
    Trace trace;
    EXPECT_EQ(detector.detect(truth.frame, {{{child, {}, 1.F, {}, size}}}, &trace).size(), 2U);
    std::ranges::stable_sort(trace.candidates, {}, &Trace::Candidate::known);
    return trace.candidates;
  };
  const auto usual = candidates_for(1.F), own = candidates_for(1.F / CapsuleBuild().stature_m);
  ASSERT_EQ(usual.size(), own.size());
  ASSERT_EQ(usual.back().known, 0);
  EXPECT_LT(own.back().refined.mean_error, 0.7F * usual.back().refined.mean_error);
  EXPECT_GT(own.back().evidence.likelihood, usual.back().evidence.likelihood);
  ASSERT_EQ(usual.front().known, -1);
  EXPECT_EQ(own.front().refined.score, usual.front().refined.score) << "nothing is known of the adult";
}

TEST_F(DetectorWithPrior, AsksOnceWhenTheFrameIsLabelled) {
  int asked = 0;
  StageTimes times;
  const Detection found = detector->detect(
      truth.frame,
      [&](const Frame& frame) {
        ++asked;
        EXPECT_EQ(&frame, &truth.frame);
        EXPECT_GT(times[Stage::label], 0.0);
        EXPECT_EQ(times[Stage::grow], 0.0);
        return Prior{{{mask_of(1), {}}}};
      },
      nullptr, &times);
  EXPECT_EQ(asked, 1);
  expect_same(found.people, detector->detect(truth.frame, {{{mask_of(1), {}}}}));
  EXPECT_EQ(found.planes.size(), find_planes(truth.frame.depth, kCamera, {}).size());
  EXPECT_FALSE(found.planes.empty());
  const AskPrior fails = [](const Frame&) -> Prior { throw Error("nobody knows"); };
  EXPECT_THROW(detector->detect(truth.frame, fails), Error);
}

/// Finds one of two people who stand side by side, in a picture of which the other's part is not looked at.
void expect_found_in_a_part(const CapsuleScene& scene, int quarters) {
  LabelledFrame truth = render(scene, kCamera, paper_body());
  const Detector detector(truth_model(truth.labels, paper_body(), true));
  const AskPrior nobody = [](const Frame&) { return Prior{}; };
  const Detection whole = detector.detect(truth.frame, nobody);
  ASSERT_EQ(whole.people.size(), 2U);
  EXPECT_TRUE(whole.whole);
  const Person& expected = whole.people[0].box.u < whole.people[1].box.u ? whole.people[0] : whole.people[1];
  constexpr int kRoom = 12;
  const Box& own = expected.box;
  const int top = std::max(0, own.v - kRoom), bottom = std::min(kCamera.height, own.v + own.height + kRoom);
  PictureRegion region{{own.u - kRoom, top, own.width + 2 * kRoom, bottom - top}, whole.planes};
  Frame frame = truth.frame;
  if (quarters != 0) {
    // A camera that is mounted so that its picture must be turned by `quarters` to be this one.
    region = turned(region, kCamera, 4 - quarters);
    frame = turned(frame, 4 - quarters);
    frame.quarter_turns = quarters;
  }
  const Detection part = detector.detect(frame, region, nobody);
  EXPECT_FALSE(part.whole);
  ASSERT_EQ(part.people.size(), 1U);
  EXPECT_EQ(part.planes.size(), whole.planes.size());
  const Detection upright = turned(part, quarters);
  const Person& found = upright.people[0];
  ASSERT_TRUE(found.mask.same_size(expected.mask));
  EXPECT_GT(shared_pixels(found.mask, expected.mask), 0.97F);
  EXPECT_EQ(found.box.u, bounding_box(found.mask).u);
  EXPECT_EQ(found.box.height, bounding_box(found.mask).height);
  for (std::size_t p = 0; p < found.skeleton.parts.size(); ++p) {
    if (expected.skeleton.parts[p].state != State::observed) continue;
    EXPECT_LT((found.skeleton.parts[p].centre - expected.skeleton.parts[p].centre).norm(), 0.02F);
  }
  Trace trace;
  if (quarters == 0) {
    EXPECT_TRUE(detector.detect(frame, region, nobody, &trace).whole) << "a trace is of the whole picture";
  }
}

TEST(DetectorInAPart, FindsWhoeverIsThereAsInTheWholePicture) {
  CapsuleScene scene = one_person(2.8F);
  scene.people.push_back(scene.people[0]);
  scene.people[0].feet.x() = -0.7F;
  scene.people[1].feet.x() = 0.8F;
  for (const int quarters : {0, 2}) {  // lying pictures have another camera than the labeller knows
    SCOPED_TRACE(quarters);
    expect_found_in_a_part(scene, quarters);
  }
}

TEST(DetectorInAPart, RefusesOneThatIsNotInThePicture) {
  const LabelledFrame truth = render(one_person(2.8F), kCamera, paper_body());
  const Detector detector(truth_model(truth.labels, paper_body(), true));
  const AskPrior nobody = [](const Frame&) { return Prior{}; };
  for (const Box& box : {Box{}, Box{0, 0, 10, 0}, Box{-1, 0, 10, 10}, Box{311, 0, 10, 10}, Box{0, 0, 10, 241},
                         Box{2147483647, 0, 10, 10}}) {
    EXPECT_THROW(detector.detect(truth.frame, PictureRegion{box, {}}, nobody), Error);
  }
}

TEST_F(DetectorWithPrior, ChangesNothingWithoutMasksOfPeople) {
  const std::vector<Person> expected = detector->detect(truth.frame);
  expect_same(detector->detect(truth.frame, Prior{}), expected);
  Prior only_looks;
  only_looks.people.push_back({{}, learn_appearance(truth.frame, mask_of(1), HueAppearance())});
  expect_same(detector->detect(truth.frame, only_looks), expected);
}

TEST_F(DetectorWithPrior, AsksTheGivenAppearance) {
  class Asked : public HueAppearance {
   public:
    std::vector<std::uint16_t> describe(const Frame& frame) const override {
      ++times;
      return HueAppearance::describe(frame);
    }
    mutable int times = 0;
  };
  const auto appearance = std::make_shared<Asked>();
  const Model labeller = lenient(std::make_shared<DoubtfulLabeller>(truth, 1));
  const std::vector<Person> expected = detector->detect(truth.frame);
  options.grow.appearance = "none";
  expect_same(Detector(labeller, options, appearance).detect(truth.frame), expected);
  EXPECT_EQ(appearance->times, 1);
  Detector(labeller, options, appearance).detect(truth.frame, {{{mask_of(1), {}}}});
  EXPECT_EQ(appearance->times, 2) << "known people look at the same";
  options.grow.appearance = "smell";
  EXPECT_THROW(Detector(labeller, options), UsageError);
}

TEST_F(DetectorWithPrior, FindsNobodyInAnEmptyMask) {
  Mask wall(kCamera.width, kCamera.height, 0);
  for (int v = 20; v < 120; ++v) std::fill_n(wall.row(v) + 250, 40, std::uint8_t{1});
  expect_same(detector->detect(truth.frame, {{{wall, {}}, {Mask(kCamera.width, kCamera.height, 0), {}}}}),
              detector->detect(truth.frame));
}

TEST_F(DetectorWithPrior, TakesMasksOfTheFramesSizeOnAGridToo) {
  options.grid.step = 2;
  options.cluster.min_pixels = 3;
  LabelledFrame coarse = truth;
  coarse.labels = every_nth(truth.labels, 2);
  coarse.person = every_nth(truth.person, 2);
  class Half : public DoubtfulLabeller {
    using DoubtfulLabeller::DoubtfulLabeller;
    void label_into(const Frame& frame, float gate, Posteriors& out) const override {
      Frame as_whole = frame;  // TruthLabeller tells by the principal point which part of its picture is shown
      as_whole.camera.cx = kCamera.cx;
      as_whole.camera.cy = kCamera.cy;
      DoubtfulLabeller::label_into(as_whole, gate, out);
    }
  };
  const Detector half(lenient(std::make_shared<Half>(coarse, 1)), options);
  EXPECT_EQ(half.detect(truth.frame).size(), 1U);
  const std::vector<Person> people = half.detect(truth.frame, {{{mask_of(1), {}}}});
  ASSERT_EQ(people.size(), 2U);
  EXPECT_TRUE(people[1].mask.same_size(truth.frame.depth));
  EXPECT_GT(overlap(people[1].mask, 1), 0.85);
}

TEST_F(DetectorWithPrior, RefusesAMaskOfAnotherSize) {
  EXPECT_THAT(
      [&] {
        detector->detect(truth.frame, {{{Mask(10, 10, 1), {}}}});
      },
      testing::ThrowsMessage<Error>(testing::HasSubstr("10x10 pixels, expected the frame's 320x240")));
}

TEST_F(DetectorWithPrior, LabelsAsDetectionDoes) {
  for (const bool background : {false, true}) {
    const Detector plain(truth_model(truth.labels, paper_body(), background));
    Trace trace;
    ASSERT_EQ(plain.detect(truth.frame, &trace).size(), 2U);
    const Trace::Candidate& candidate = trace.candidates.front();
    const FrameLabels labels = plain.label(truth.frame, &candidate.grown);
    EXPECT_EQ(labels.labels, trace.labels);
    EXPECT_EQ(labels.inside, candidate.labels);
    EXPECT_TRUE(plain.label(truth.frame).inside.empty());
    EXPECT_EQ(plain.label(truth.frame).labels, trace.labels);
  }
}

TEST(Detector, MeasuresTimesThatAddUp) {
  const LabelledFrame truth = render(one_person(2.F), kCamera, paper_body());
  const Detector detector(std::make_shared<TruthLabeller>(truth.labels, paper_body(), true));
  StageTimes times;
  detector.detect(truth.frame, nullptr, &times);
  for (const double ms : times.ms) EXPECT_GE(ms, 0.0);
  EXPECT_GT(times[Stage::label], 0.0);
  const double once = times.total();
  detector.detect(truth.frame, nullptr, &times);
  EXPECT_GT(times.total(), once);
}

TEST(Judge, DecidesWhoIsAPerson) {
  const LabelledFrame truth = render(one_person(2.F), kCamera, paper_body());
  constexpr int kSize = 5;  // the likeness of the area, in the order of kJudgedEvidence
  for (const float least : {0.F, 1.F}) {
    Model model(std::make_shared<TruthLabeller>(truth.labels, paper_body(), true));
    model.judge = judge_by(kSize, least);
    const std::vector<Person> people = Detector(model).detect(truth.frame);
    ASSERT_EQ(people.size(), least == 0.F ? 1U : 0U);
    if (least == 0.F) {
      EXPECT_GT(people[0].score, 0.99F);
    }
  }
}

TEST(Judge, OfOtherEvidenceIsRefused) {
  Model model(std::make_shared<TruthLabeller>(LabelImage(), paper_body(), true));
  model.judge = judge_by(0, 0.F);
  model.judge.asks = {};
  model.judge.features = 34;
  EXPECT_THAT([&] { Detector{model}; },
              testing::ThrowsMessage<Error>(testing::HasSubstr("judge of people knows 34 features, expected 35")));
  model.judge.features = 35;
  EXPECT_NO_THROW(Detector{model}) << "without names it knows nothing of votes";
  model.judge = judge_by(0, 0.F);
  model.judge.asks.back() = "part:tail";
  EXPECT_THAT([&] { Detector{model}; },
              testing::ThrowsMessage<Error>(testing::HasSubstr("judge of people asks for \"part:tail\"")));
}

/// A labeller whose pixels rather say that the person is seen from the front, while all of them together say from
/// behind, which is true. The pixels of the left hand can only be those of a right one.
class RatherFromTheFront : public Labeller {
 public:
  explicit RatherFromTheFront(LabelImage truth) : truth_(std::move(truth)) {}
  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    const LogitLayout layout(paper_body(), true, 8);
    out = test::headed_posteriors(depth);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0) continue;
        const int part = truth_(u, v);
        if (part == kBackground) {
          out.at(u, v)[25] = 255;
          continue;
        }
        const int mirror = paper_body().parts[part].mirror;
        const bool only = part == paper_body().find_part("l_hand");
        out.at(u, v)[mirror] = only ? 255 : 128;
        if (!only) out.at(u, v)[part] = static_cast<std::uint16_t>(out.at(u, v)[part] + 127);
        out.turns_at(u, v)[layout.side[mirror] * 8 + 0] = 32768;
        out.turns_at(u, v)[layout.side[only ? mirror : part] * 8 + 4] = 32767;
      }
    }
  }

 private:
  LabelImage truth_;
};

TEST(Facing, NoLikelierSkeletonWithTheSidesSwappedIsKept) {
  CapsuleScene scene = one_person(2.F);
  scene.people[0].pose.yaw = std::numbers::pi_v<float>;
  const LabelledFrame truth = render(scene, kCamera, paper_body());
  DetectOptions options;
  options.refine.min_score = 0.F;
  Trace trace;
  Model model(std::make_shared<RatherFromTheFront>(truth.labels));
  model.headings = test::seen_from_behind();
  const std::vector<Person> people = Detector(model, options).detect(truth.frame, &trace);
  ASSERT_EQ(people.size(), 1U);
  const Skeleton& skeleton = people[0].skeleton;
  ASSERT_GT(trace.rough.front().score, skeleton.score) << "the first pass alone would be preferred";
  int own = 0, swapped = 0;
  for (int p = 0; p < paper_body().part_count(); ++p) {
    const int mirror = paper_body().parts[p].mirror;
    if (mirror == p || mirror < 0 || skeleton.parts[p].state != State::observed) continue;
    const float to_own = (skeleton.parts[p].centre - truth.parts[0][p]).norm();
    const float to_mirror = (skeleton.parts[p].centre - truth.parts[0][mirror]).norm();
    ++(to_own < to_mirror ? own : swapped);
  }
  EXPECT_GT(own, 16);
  EXPECT_LE(swapped, 1);
}

/// A labeller that sees true parts and is 40 percent sure that they are a body.
class Doubtful : public Labeller {
 public:
  explicit Doubtful(LabelImage truth) : truth_(std::move(truth)) {}
  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const DepthImage& depth = frame.depth;
    out = {depth.width(), depth.height(), 26, 255, {}};
    out.sums.assign(depth.size() * 26, 0);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0) continue;
        const int part = truth_(u, v);
        if (part != kBackground) out.at(u, v)[part] = 102;
        out.at(u, v)[25] = part != kBackground ? 153 : 255;
      }
    }
  }

 private:
  LabelImage truth_;
};

TEST(Context, LabelsFollowItAndPeopleAreJudgedByTheForestAlone) {
  const LabelledFrame truth = render(one_person(2.F), kCamera, paper_body());
  DetectOptions options;
  options.refine.min_score = 0.F;
  options.label.background_weight = options.label.proposal_weight = 1.F;
  Model model(std::make_shared<Doubtful>(truth.labels));
  EXPECT_TRUE(Detector(model, options).detect(truth.frame).empty()) << "everything is rather the background";
  model.context = {BodySurroundings::feature_count(paper_body()), 2.F, {BoostedTree{}}};
  Trace trace;
  ASSERT_EQ(Detector(model, options).detect(truth.frame, &trace).size(), 1U);
  EXPECT_NEAR(trace.candidates.front().evidence.body, 0.4F, 0.05F);
  EXPECT_GT(trace.candidates.front().refined.found, 20);
}

/// Returns the frame's depth with the ramps around its holes that resizing by interpolation leaves.
DepthImage with_ramps(DepthImage depth) {
  const DepthImage sharp = depth;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 1; u < depth.width(); ++u) {
      if (sharp(u, v) != 0 && sharp(u - 1, v) == 0) depth(u, v) = static_cast<std::uint16_t>(sharp(u, v) / 2);
    }
  }
  return depth;
}

TEST(Blended, ReadingsBesideHolesBelongToNobody) {
  LabelledFrame truth = render(one_person(2.F), kCamera, paper_body());
  // A hole down the middle of the person.
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 165; u < 168; ++u) truth.frame.depth(u, v) = 0;
  }
  truth.frame.depth = with_ramps(truth.frame.depth);
  const std::vector<Person> people = detect_truth(truth, true);
  ASSERT_EQ(people.size(), 1U);
  DetectOptions as_it_is;
  as_it_is.blend.least_share = 0.F;
  const std::vector<Person> with = detect_truth(truth, true, paper_body(), as_it_is);
  ASSERT_EQ(with.size(), 1U);
  int ramps = 0, kept = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    ramps += people[0].mask(168, v);
    kept += people[0].mask(169, v);
  }
  EXPECT_EQ(ramps, 0);
  EXPECT_GT(kept, 20);
}

}  // namespace
}  // namespace vesalius
