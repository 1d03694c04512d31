#include "vesalius/propose_people.h"

#include <gmock/gmock.h>

#include <limits>
#include <memory>
#include <numbers>

#include "capsule/capsule_person.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/detect.h"
#include "vesalius/score_person.h"
#include "vesalius/test_votes.h"

namespace vesalius {
namespace {

const Camera kCamera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};

/// A judge that takes whatever has more than `least` of a kind of evidence for a person.
BoostedTrees judge_by(const char* evidence, float least) {
  BoostedTrees judge{1, 0.F, std::vector<BoostedTree>(1), {evidence}};
  BoostedTree& tree = judge.trees.front();
  tree.threshold.fill(std::numeric_limits<float>::infinity());
  tree.threshold[0] = least;
  tree.value.fill(-9.F);
  tree.value[BoostedTree::kLeaves / 2] = 9.F;
  return judge;
}

CapsuleScene people_at(const std::vector<Eigen::Vector3f>& feet) {
  CapsuleScene scene;
  scene.floor_y_m = 0.9F;
  for (const Eigen::Vector3f& at : feet) scene.people.emplace_back().feet = at;
  return scene;
}

/// A labeller whose votes are taken away.
class WithoutVotes : public test::VotingLabeller {
 public:
  using VotingLabeller::VotingLabeller;
  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    VotingLabeller::label_into(frame, gate, out);
    out.votes = {};
  }
};

struct Found {
  std::vector<Person> people;
  Trace trace;
};

template <class Labels = test::VotingLabeller>
Found find(const LabelledFrame& truth, float noise_m, BoostedTrees judge = {}) {
  Model model(std::make_shared<Labels>(truth, noise_m));
  model.judge = std::move(judge);
  Found found;
  found.people = Detector(model).detect(truth.frame, &found.trace);
  return found;
}

/// Returns the pixels in both a mask and a person over those in either.
double overlap(const Mask& mask, const LabelledFrame& truth, int who) {
  long both = 0, either = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const bool is = truth.person[i] == who;
    both += mask[i] != 0 && is ? 1 : 0;
    either += mask[i] != 0 || is ? 1 : 0;
  }
  return double(both) / double(either);
}

/// Returns how many true people have a found one whose mask is theirs.
int count_right(const Found& found, const LabelledFrame& truth) {
  int right = 0;
  for (int who = 0; who < std::ssize(truth.parts); ++who) {
    right += std::ranges::any_of(found.people, [&](const Person& p) { return overlap(p.mask, truth, who) > 0.8; });
  }
  return right;
}

void expect_same(const std::vector<Person>& a, const std::vector<Person>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].mask, b[i].mask);
    EXPECT_EQ(a[i].labels, b[i].labels);
    EXPECT_EQ(a[i].score, b[i].score);
    ASSERT_TRUE(a[i].yaw && b[i].yaw);
    EXPECT_EQ(a[i].yaw->yaw_rad, b[i].yaw->yaw_rad);
  }
}

TEST(ProposePeople, TwoWhoTouchAndWhomTheSearchJoinsAreTwoWithVotes) {
  const LabelledFrame truth = render(people_at({{-0.2F, 0.9F, 2.5F}, {0.2F, 0.9F, 2.5F}}), kCamera, paper_body());
  const Found without = find<WithoutVotes>(truth, 0.05F), with = find(truth, 0.05F);
  ASSERT_EQ(without.people.size(), 1U);
  EXPECT_EQ(with.people.size(), 2U);
  EXPECT_EQ(count_right(with, truth), 2);
  for (const Person& person : with.people) {
    EXPECT_GE(person.skeleton.found, 15);
    ASSERT_TRUE(person.yaw);
    EXPECT_NEAR(person.yaw->yaw_rad, 0.F, 0.1F);
  }
}

TEST(ProposePeople, WithoutVotesCandidatesKnowNothingOfGroups) {
  const LabelledFrame truth = render(people_at({{0.F, 0.9F, 2.5F}}), kCamera, paper_body());
  const Found found = find<WithoutVotes>(truth, 0.F);
  ASSERT_EQ(found.people.size(), 1U);
  EXPECT_FALSE(found.people[0].yaw);
  for (const Trace::Candidate& candidate : found.trace.candidates) {
    EXPECT_EQ(candidate.group, -1);
    const Evidence& e = candidate.evidence;
    for (const float of_votes : {e.votes, e.spread_m, e.likely, e.agree, e.heading, e.sided, e.groups}) {
      EXPECT_EQ(of_votes, 0.F);
    }
  }
}

/// Somebody of whom labels show nothing but one part.
LabelledFrame one_part(const char* name) {
  LabelledFrame truth = render(people_at({{0.1F, 0.9F, 1.6F}}), kCamera, paper_body());
  const int part = paper_body().find_part(name);
  for (std::uint8_t& label : truth.labels) label = label == part ? label : kBackground;
  for (std::size_t i = 0; i < truth.person.size(); ++i) {
    if (truth.labels[i] == kBackground) truth.person[i] = kBackground;
  }
  return truth;
}

TEST(ProposePeople, SomebodyOfWhomOneLargePartIsSeenIsFound) {
  const LabelledFrame truth = one_part("l_chest");
  EXPECT_TRUE(find<WithoutVotes>(truth, 0.05F, judge_by("body", 0.5F)).people.empty());
  const Found found = find(truth, 0.05F, judge_by("agree", 0.5F));
  ASSERT_EQ(found.people.size(), 1U);
  const Person& person = found.people[0];
  EXPECT_GT(overlap(person.mask, truth, 0), 0.8);
  EXPECT_GT(person.box.width, 10);
  EXPECT_EQ(person.skeleton.found, 1);
  EXPECT_EQ(person.skeleton.parts[paper_body().find_part("l_chest")].state, State::observed);
  EXPECT_EQ(person.joints.size(), paper_body().joint_sets.size());
}

TEST(ProposePeople, SomebodyOfWhomNoPartIsFoundHasABoxAndAMask) {
  const LabelledFrame truth = one_part("l_chest");
  Model model(std::make_shared<test::VotingLabeller>(truth, 0.05F));
  model.judge = judge_by("agree", 0.5F);
  DetectOptions options;
  options.cluster.max_extent_scale = 0.1F;  // no part is so small
  const std::vector<Person> people = Detector(model, options).detect(truth.frame);
  ASSERT_EQ(people.size(), 1U);
  EXPECT_EQ(people[0].skeleton.found, 0);
  EXPECT_EQ(people[0].skeleton.parts.size(), paper_body().parts.size());
  EXPECT_GT(overlap(people[0].mask, truth, 0), 0.8);
}

/// A labeller that knows besides where each person's parts are, the hidden ones too.
class KnowsAllParts : public test::VotingLabeller {
 public:
  KnowsAllParts(const LabelledFrame& truth, float noise_m) : VotingLabeller(truth, noise_m), truth_(truth) {}
  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    VotingLabeller::label_into(frame, gate, out);
    const auto part = [](int size) { return (size + kPartVoteStep - 1) / kPartVoteStep; };
    out.part_votes = {.width = part(out.width), .height = part(out.height), .parts = out.classes - 1};
    for (int row = 0; row < out.part_votes.height; ++row) {
      for (int column = 0; column < out.part_votes.width; ++column) {
        const int u = column * kPartVoteStep, v = row * kPartVoteStep, who = truth_.person(u, v);
        for (int p = 0; p < out.part_votes.parts; ++p) {
          Eigen::Vector3f way = Eigen::Vector3f::Zero();
          if (who != kBackground) way = truth_.parts[who][p] - point_at(frame.camera, frame.depth, u, v);
          for (int axis = 0; axis < 3; ++axis)
            out.part_votes.ways_mm.push_back(std::int16_t(std::lround(1e3F * way[axis])));
        }
      }
    }
  }

 private:
  LabelledFrame truth_;
};

/// Returns how many parts of the only person found are given within 12 cm of the truth.
template <class Labels>
int count_parts_given(const LabelledFrame& truth) {
  const Found found = find<Labels>(truth, 0.05F, judge_by("agree", 0.5F));
  EXPECT_EQ(found.people.size(), 1U);
  int given = 0;
  for (int p = 0; p < paper_body().part_count(); ++p) {
    const SkeletonPart& part = found.people.at(0).skeleton.parts[p];
    given += part.state != State::none && (part.centre - truth.parts[0][p]).norm() < 0.12F ? 1 : 0;
  }
  return given;
}

TEST(ProposePeople, VotesPlacePartsThatAreNotSeen) {
  const LabelledFrame truth = one_part("l_chest");
  EXPECT_EQ(count_parts_given<test::VotingLabeller>(truth), 1);
  EXPECT_GT(count_parts_given<KnowsAllParts>(truth), 15);
}

/// A room without people, with a box that labels take for parts of all kinds.
LabelledFrame haunted_box() {
  CapsuleScene scene;
  scene.boxes.push_back({{-0.4F, -0.3F, 2.F}, {0.3F, 0.6F, 2.4F}, {}});
  LabelledFrame truth = render(scene, kCamera, paper_body());
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const int z_mm = truth.frame.depth(u, v);
      if (z_mm >= 2000 && z_mm < 2390 && v < 190) truth.labels(u, v) = std::uint8_t((u / 12 + 5 * (v / 12)) % 25);
    }
  }
  return truth;
}

TEST(ProposePeople, VotesForPlacesAllAroundMakeNoPerson) {
  const LabelledFrame truth = haunted_box();
  const Found found = find(truth, 0.F, judge_by("agree", 0.5F));
  EXPECT_TRUE(found.people.empty());
  ASSERT_FALSE(found.trace.candidates.empty()) << "somebody is proposed";
  EXPECT_GT(found.trace.candidates[0].evidence.spread_m, 0.25F);
  EXPECT_LT(found.trace.candidates[0].evidence.heading, 0.3F);
}

/// A labeller that takes the pixels of person 1 for rather the background, so that they do not vote.
class DoubtsTheSecond : public test::VotingLabeller {
 public:
  DoubtsTheSecond(const LabelledFrame& truth, float noise_m) : VotingLabeller(truth, noise_m), person_(truth.person) {}
  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    VotingLabeller::label_into(frame, gate, out);
    for (int v = 0; v < out.height; ++v) {
      for (int u = 0; u < out.width; ++u) {
        if (person_(u, v) == 1) out.at(u, v)[out.classes - 1] = 300;
      }
    }
  }

 private:
  Image<std::uint8_t> person_;
};

TEST(ProposePeople, RoughSkeletonsOutsideOfAllGroupsAreCandidatesToo) {
  const LabelledFrame truth = render(people_at({{-0.7F, 0.9F, 2.5F}, {0.7F, 0.9F, 2.8F}}), kCamera, paper_body());
  const Found found = find<DoubtsTheSecond>(truth, 0.02F, judge_by("explained", 0.2F));
  EXPECT_EQ(count_right(found, truth), 2);
  ASSERT_EQ(found.trace.candidates.size(), 2U) << "and none of the person who has a group";
  EXPECT_NE(found.trace.candidates[0].group, found.trace.candidates[1].group);
}

TEST(ProposePeople, MasksOfGroupsShareNoPixel) {
  const LabelledFrame truth =
      render(people_at({{-0.4F, 0.9F, 2.4F}, {0.F, 0.9F, 2.5F}, {0.4F, 0.9F, 2.6F}}), kCamera, paper_body());
  const Found found = find(truth, 0.08F);
  const VoteGroups groups = group_votes(test::VotingLabeller(truth, 0.08F).label(truth.frame), truth.frame, 25);
  ASSERT_EQ(groups.items.size(), 3U);
  for (const Trace::Candidate& candidate : found.trace.candidates) {
    ASSERT_GE(candidate.group, 0);
    for (std::size_t i = 0; i < candidate.grown.size(); ++i) {
      if (candidate.grown[i] == 0 || groups.index[i] == kBackground) continue;
      ASSERT_EQ(groups.index[i], candidate.group);
    }
  }
  Mask taken(kCamera.width, kCamera.height, 0);
  for (const Person& person : found.people) {
    for (std::size_t i = 0; i < taken.size(); ++i) taken[i] = std::uint8_t(taken[i] + person.mask[i]);
  }
  EXPECT_LE(*std::ranges::max_element(taken), 1);
  EXPECT_EQ(count_right(found, truth), 3);
}

TEST(ProposePeople, EvidenceTellsWhetherVotesHeadingAndSidesAgree) {
  CapsuleScene scene = people_at({{0.F, 0.9F, 2.5F}});
  scene.people[0].pose.yaw = std::numbers::pi_v<float>;
  LabelledFrame truth = render(scene, kCamera, paper_body());
  const Evidence right = find(truth, 0.05F).trace.candidates.at(0).evidence;
  EXPECT_GT(right.agree, 0.9F);
  EXPECT_GT(right.sided, 0.9F);
  EXPECT_GT(right.heading, 0.99F);
  EXPECT_NEAR(right.spread_m, 0.087F, 0.01F);
  EXPECT_GT(right.likely, 6.F);
  EXPECT_EQ(right.groups, 1.F);
  EXPECT_GT(right.votes, 2.F);
  // Labels mirrored, votes as before.
  for (std::uint8_t& label : truth.labels) {
    if (label != kBackground) label = std::uint8_t(paper_body().parts[label].mirror);
  }
  const Found mirrored = find(truth, 0.05F);
  EXPECT_LT(mirrored.trace.candidates.at(0).evidence.sided, -0.9F);
  ASSERT_EQ(mirrored.people.size(), 1U);
  EXPECT_GT(std::abs(mirrored.people[0].yaw->yaw_rad), 3.F) << "the heading is that of the votes";
}

TEST(ProposePeople, GivesTheSamePeopleForAnyNumberOfThreads) {
  const LabelledFrame truth =
      render(people_at({{-0.6F, 0.9F, 2.2F}, {0.F, 0.9F, 2.5F}, {0.4F, 0.9F, 2.6F}}), kCamera, paper_body());
  const std::vector<Person> first = find(truth, 0.1F).people;
  EXPECT_EQ(first.size(), 3U);
  for_threads({1, 2, 7}, [&] { expect_same(find(truth, 0.1F).people, first); });
}

TEST(ProposePeople, AKnownPersonWhomJudgesRefuseIsJudgedByVotesToo) {
  const LabelledFrame truth = render(people_at({{0.F, 0.9F, 2.5F}}), kCamera, paper_body());
  Model model(std::make_shared<test::VotingLabeller>(truth, 0.05F));
  model.judge = judge_by("open", 2.F);  // nobody passes, so whoever is known is looked for again
  Mask expected(kCamera.width, kCamera.height, 0);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = truth.person[i] == 0 ? 1 : 0;
  Trace trace;
  Detector(model).detect(truth.frame, Prior{{{expected, {}}}}, &trace);
  ASSERT_EQ(trace.candidates.size(), 2U);
  for (const Trace::Candidate& candidate : trace.candidates) {
    EXPECT_EQ(candidate.known, 0);
    EXPECT_EQ(candidate.group, 0);
    EXPECT_GT(candidate.evidence.agree, 0.9F);
  }
}

/// Somebody whose flesh is known between two parts alone.
Prior::KnownPerson known_between(const LabelledFrame& truth, std::size_t who, const char* from, const char* to,
                                 float odds) {
  const auto at = [&](const char* part) { return truth.parts[who][std::size_t(paper_body().find_part(part))]; };
  return {{}, {}, odds, {{at(from), at(to), 0.1F, 0.1F}}};
}

TEST(ProposePeople, APieceThatOnlyThePriorTellsIsNoSecondPerson) {
  const LabelledFrame truth = render(people_at({{0.F, 0.9F, 2.5F}}), kCamera, paper_body());
  Model model(std::make_shared<test::VotingLabeller>(truth, 0.05F));
  model.judge = judge_by("core", 0.5F);  // takes the whole person, and no leg
  for (const float odds : {1.F, 1e6F}) {
    const Prior prior{
        {known_between(truth, 0, "neck", "l_thigh", 20.F), known_between(truth, 0, "l_leg", "l_foot", odds)}};
    Trace trace;
    const std::vector<Person> people = Detector(model).detect(truth.frame, prior, &trace);
    ASSERT_EQ(trace.candidates.size(), 2U);
    ASSERT_EQ(people.size(), 1U) << odds;
    EXPECT_GT(overlap(people[0].mask, truth, 0), 0.95);
    EXPECT_GT(people[0].skeleton.found, 15);
    long labelled = 0, pixels = 0;
    for (std::size_t i = 0; i < truth.labels.size(); ++i) {
      const bool leg = truth.labels[i] == paper_body().find_part("l_leg");
      pixels += leg ? 1 : 0;
      labelled += leg && people[0].labels[i] == truth.labels[i] ? 1 : 0;
    }
    EXPECT_GT(labelled, pixels / 2) << "the pixels keep their parts";
  }
}

TEST(ProposePeople, WhoMovedIsKnownByThePieceThatIsWhereExpected) {
  const LabelledFrame truth = render(people_at({{0.F, 0.9F, 2.5F}}), kCamera, paper_body());
  Model model(std::make_shared<test::VotingLabeller>(truth, 0.05F));
  model.judge = judge_by("groups", 0.5F);  // takes everybody
  const Prior prior{{known_between(truth, 0, "l_foot", "l_foot", 20.F)}};
  Trace trace;
  const std::vector<Person> people = Detector(model).detect(truth.frame, prior, &trace);
  ASSERT_EQ(people.size(), 1U);
  EXPECT_GT(overlap(people[0].mask, truth, 0), 0.95);
  ASSERT_EQ(trace.candidates.size(), 1U) << "the foot is no candidate of its own";
  EXPECT_EQ(trace.candidates[0].known, 0);
}

TEST(ProposePeople, TwoKnownPeopleWhoAreClearStayTwoThoughTheirVotesAgree) {
  LabelledFrame truth = render(people_at({{-0.25F, 0.9F, 2.5F}, {0.25F, 0.9F, 2.5F}}), kCamera, paper_body());
  const LabelledFrame both = truth;
  for (std::uint8_t& person : truth.person) person = person == 1 ? 0 : person;
  Model model(std::make_shared<test::VotingLabeller>(truth, 0.05F));
  model.judge = judge_by("groups", 0.5F);  // takes everybody
  const Prior prior{{known_between(both, 0, "neck", "l_leg", 20.F), known_between(both, 1, "neck", "l_leg", 20.F)}};
  EXPECT_EQ(Detector(model).detect(truth.frame, prior).size(), 2U);
}

}  // namespace
}  // namespace vesalius
