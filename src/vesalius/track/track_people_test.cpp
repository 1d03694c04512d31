#include "vesalius/track_people.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <set>

#include "capsule/capsule_person.h"
#include "vesalius/base/random.h"
#include "vesalius/derive_joints.h"
#include "vesalius/error.h"
#include "vesalius/fit/body_history.h"
#include "vesalius/fit/fit_body.h"
#include "vesalius/prior.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

const Camera kCamera{160, 120, 131.F, 131.F, 79.5F, 59.5F};
constexpr float kWall_m = 5.F;
constexpr double kFrame_s = 1.0 / 30.0;

/// Somebody in a fake scene: an upright board of one colour.
struct Actor {
  Vector3f trunk{0.F, 0.F, 2.5F};
  Rgb colour{200, 30, 30};
  float score = 0.95F;
  float size = 1.F;
  bool found = true;
  bool lies = false;  ///< on a side, with the hips as only parts in sight
};

/// A frame with boards before a wall, the nearer ones in front.
class Stage {
 public:
  explicit Stage(const std::vector<Actor>& actors, const Camera& camera = kCamera)
      : owner_(camera.width, camera.height, kBackground) {
    frame.camera = camera;
    frame.depth = DepthImage(camera.width, camera.height, static_cast<std::uint16_t>(kWall_m * 1e3F));
    frame.colour = ColourImage(camera.width, camera.height, {120, 120, 120});
    for (std::size_t i = 0; i < actors.size(); ++i) draw(actors[i], static_cast<std::uint8_t>(i));
    for (std::size_t i = 0; i < actors.size(); ++i) {
      if (actors[i].found) find(actors[i], static_cast<std::uint8_t>(i));
    }
  }

  Frame frame;
  std::vector<Person> people;
  std::vector<std::size_t> actor_of;  ///< index of the actor of each of `people`

 private:
  void draw(const Actor& actor, std::uint8_t index) {
    const auto z_mm = static_cast<std::uint16_t>(actor.trunk.z() * 1e3F);
    const Eigen::Vector2f at = frame.camera.pixel(actor.trunk);
    const float wide_m = actor.lies ? 0.7F : 0.22F, high_m = actor.lies ? 0.22F : 0.7F;
    const float half_u = wide_m / actor.trunk.z() * frame.camera.fx;
    const float half_v = high_m / actor.trunk.z() * frame.camera.fy;
    for (int v = 0; v < frame.depth.height(); ++v) {
      for (int u = 0; u < frame.depth.width(); ++u) {
        const bool inside =
            std::abs(static_cast<float>(u) - at.x()) <= half_u && std::abs(static_cast<float>(v) - at.y()) <= half_v;
        if (!inside || frame.depth(u, v) <= z_mm) continue;
        frame.depth(u, v) = z_mm;
        frame.colour(u, v) = actor.colour;
        owner_(u, v) = index;
      }
    }
  }

  void find(const Actor& actor, std::uint8_t index) {
    Person person;
    person.score = actor.score;
    person.mask = Mask(frame.depth.width(), frame.depth.height(), 0);
    person.labels = LabelImage(frame.depth.width(), frame.depth.height(), kBackground);
    int pixels = 0;
    for (std::size_t i = 0; i < owner_.size(); ++i) {
      if (owner_[i] != index) continue;
      person.mask[i] = 1;
      person.labels[i] = 0;
      ++pixels;
    }
    if (pixels == 0) return;
    const BodyModel& body = paper_body();
    person.skeleton.parts.resize(body.parts.size());
    const auto part = [&](const char* name, float x, float y) {
      SkeletonPart& p = person.skeleton.parts[static_cast<std::size_t>(body.find_part(name))];
      p.state = State::observed;
      p.centre = actor.trunk + actor.size * Vector3f(x, y, 0.F);
      p.confidence = 0.8F;
      ++person.skeleton.found;
    };
    part("l_hips", 0.1F, 0.2F), part("r_hips", -0.1F, 0.2F);
    if (!actor.lies) {
      part("l_chest", 0.1F, -0.2F), part("r_chest", -0.1F, -0.2F);
      part("neck", 0.F, -0.4F), part("l_face_bottom", 0.03F, -0.55F), part("r_face_bottom", -0.03F, -0.55F);
    }
    person.joints = derive_joints(body, person.skeleton);
    people.push_back(std::move(person));
    actor_of.push_back(index);
  }

  Image<std::uint8_t> owner_;
};

std::shared_ptr<const Appearance> hue() { return std::make_shared<HueAppearance>(); }

/// Follows actors and remembers which id each of them had.
class Follower {
 public:
  explicit Follower(TrackOptions options = {}) : tracker(paper_body(), options, hue()) {}

  TrackedFrame show(const std::vector<Actor>& actors) {
    Stage stage(actors);
    stage.frame.time_s = static_cast<double>(frames_++) * kFrame_s;
    const std::vector<Person> people = stage.people;
    TrackedFrame tracked = tracker.update(stage.frame, {stage.people});
    for (const TrackedPerson& person : tracked.people) {
      if (person.state != TrackState::tracked && person.state != TrackState::fresh) continue;
      for (std::size_t i = 0; i < people.size(); ++i) {
        if (people[i].mask == person.person.mask) ids[stage.actor_of[i]].insert(person.id);
      }
    }
    return tracked;
  }
  void show(const std::vector<Actor>& actors, int frames) {
    for (int i = 0; i < frames; ++i) show(actors);
  }

  PeopleTracker tracker;
  std::map<std::size_t, std::set<int>> ids;  ///< of each actor

 private:
  int frames_ = 0;
};

TEST(TrackPeople, SomebodyIsNewAtFirstThenTracked) {
  Follower follower;
  const std::vector<Actor> one{{}};
  std::vector<TrackState> states;
  for (int i = 0; i < 4; ++i) states.push_back(follower.show(one).people.at(0).state);
  EXPECT_THAT(states,
              testing::ElementsAre(TrackState::fresh, TrackState::fresh, TrackState::tracked, TrackState::tracked));
  const TrackedFrame last = follower.show(one);
  EXPECT_EQ(last.people[0].id, 1);
  EXPECT_EQ(last.people[0].since_s, 0.0);
  EXPECT_EQ(last.people[0].seen_s, last.time_s);
  EXPECT_NEAR((last.people[0].position - one[0].trunk).norm(), 0.F, 0.02F);
}

TEST(TrackPeople, AGuessThatStaysWeakIsNeverSure) {
  Follower follower;
  Actor weak;
  weak.score = 0.6F;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(follower.show({weak}).people.at(0).state, TrackState::fresh);
  follower.show(std::vector<Actor>{}, 60);
  for (const TrackedPerson& person : follower.show(std::vector<Actor>{}).people) ADD_FAILURE() << person.id;
}

TEST(TrackPeople, WhoShowsLimbsAloneKeepsTheTrunkInPlace) {
  PeopleTracker tracker(paper_body(), {}, hue());
  const Actor actor;
  TrackedFrame tracked;
  for (int i = 0; i < 20; ++i) {
    Stage stage({actor});
    stage.frame.time_s = i * kFrame_s;
    if (i >= 10) {
      for (SkeletonPart& part : stage.people[0].skeleton.parts) {
        if (part.state == State::observed) part.state = State::predicted;
      }
      SkeletonPart& knee = stage.people[0].skeleton.parts[std::size_t(paper_body().find_part("l_knee"))];
      knee.state = State::observed;
      knee.centre = actor.trunk + Vector3f(0.1F, 0.6F, 0.F);
    }
    tracked = tracker.update(stage.frame, {stage.people});
  }
  ASSERT_EQ(tracked.people.size(), 1U);
  EXPECT_EQ(tracked.people[0].state, TrackState::tracked);
  EXPECT_NEAR((tracked.people[0].position - actor.trunk).norm(), 0.F, 0.02F);
}

TEST(TrackPeople, WhoIsHiddenIsPredictedComesBackOrIsLost) {
  Follower follower;
  Actor walker;
  for (int i = 0; i < 30; ++i) {
    walker.trunk.x() = -0.8F + 0.8F * static_cast<float>(i * kFrame_s);
    follower.show({walker});
  }
  walker.found = false;
  for (int i = 0; i < 10; ++i) {
    walker.trunk.x() += 0.8F * static_cast<float>(kFrame_s);
    const TrackedFrame hidden = follower.show({walker});
    ASSERT_EQ(hidden.people.size(), 1U);
    EXPECT_EQ(hidden.people[0].state, TrackState::hidden);
    EXPECT_NEAR((hidden.people[0].position - walker.trunk).norm(), 0.F, 0.1F);
    const auto neck = static_cast<std::size_t>(paper_body().find_part("neck"));
    EXPECT_EQ(hidden.people[0].person.skeleton.parts[neck].state, State::predicted);
    EXPECT_LT(hidden.people[0].person.skeleton.parts[neck].confidence, 0.8F);
    EXPECT_TRUE(hidden.people[0].person.mask.empty());
  }
  walker.found = true;
  EXPECT_EQ(follower.show({walker}).people.at(0).state, TrackState::tracked);
  EXPECT_THAT(follower.ids[0], testing::ElementsAre(1));
  int lost = 0;
  for (int i = 0; i < 120; ++i) {
    for (const TrackedPerson& person : follower.show(std::vector<Actor>{}).people)
      lost += person.state == TrackState::lost ? 1 : 0;
  }
  EXPECT_EQ(lost, 1) << "told once";
  EXPECT_TRUE(follower.show(std::vector<Actor>{}).people.empty());
}

TEST(TrackPeople, WhoRestsHasAPlaceThoughNotFound) {
  Follower follower;
  Actor resting;
  follower.show({resting}, 29);
  const Person found = follower.show({resting}).people.at(0).person;
  resting.found = false;
  for (int i = 0; i < 20; ++i) {
    const TrackedPerson hidden = follower.show({resting}).people.at(0);
    EXPECT_EQ(hidden.state, TrackState::hidden);
    EXPECT_EQ(hidden.person.mask, found.mask);
    EXPECT_EQ(hidden.person.box.u, found.box.u);
    EXPECT_EQ(hidden.person.box.height, found.box.height);
    EXPECT_TRUE(hidden.person.labels.same_size(found.labels));
    EXPECT_NEAR((hidden.position - resting.trunk).norm(), 0.F, 0.02F);
    EXPECT_EQ(hidden.velocity, Vector3f::Zero());
  }
  const TrackedPerson gone = follower.show(std::vector<Actor>{}).people.at(0);
  EXPECT_TRUE(gone.person.mask.empty()) << "the wall is seen where somebody was";
  EXPECT_EQ(gone.person.box.width, 0);
}

TEST(TrackPeople, WhoRestsMayMoveALittle) {
  // Half of the board's pixels stay as they were, then a quarter.
  const auto shown_after = [](float moved_m, int resting_frames) {
    Follower follower;
    Actor actor;
    follower.show({actor}, 30);
    actor.found = false;
    follower.show({actor}, resting_frames);
    actor.trunk.x() += moved_m;
    return !follower.show({actor}).people.at(0).person.mask.empty();
  };
  EXPECT_FALSE(shown_after(0.22F, 0)) << "that much is no rest to begin with";
  EXPECT_TRUE(shown_after(0.22F, 5));
  EXPECT_FALSE(shown_after(0.33F, 5)) << "went away";
}

/// Returns the part of somebody above or below a row.
Person piece_of(Person person, int row, bool above) {
  for (int v = 0; v < person.mask.height(); ++v) {
    for (int u = 0; u < person.mask.width(); ++u) {
      if ((v < row) != above) person.mask(u, v) = 0;
    }
  }
  return person;
}

TEST(TrackPeople, WhoIsTakenForTwoIsOneAgainUnderTheOldId) {
  for (const int two : {4, 90}) {  // frames
    const Stage stage({Actor{}});
    const Person& whole = stage.people[0];
    // The legs are a third of the board.
    const Person trunk = piece_of(whole, 75, true), legs = piece_of(whole, 75, false);
    PeopleTracker tracker(paper_body(), {}, hue());
    int frames = 0;
    const auto show = [&](const std::vector<Person>& people) {
      Frame frame = stage.frame;
      frame.time_s = frames++ * kFrame_s;
      return tracker.update(frame, {people});
    };
    for (const int before : {30, 90}) {
      for (int i = 0; i < before; ++i) show({whole});
      for (int i = 0; i < two; ++i) show({legs, trunk});
    }
    std::set<int> followed;
    for (int i = 0; i < 3; ++i) {
      followed.clear();
      for (const TrackedPerson& person : show({whole}).people) {
        if (person.state == TrackState::lost) continue;
        followed.insert(person.id);
        EXPECT_EQ(person.state == TrackState::hidden, person.person.mask.empty()) << "hidden, with another's pixels";
      }
    }
    if (two == 4) {
      EXPECT_THAT(followed, testing::ElementsAre(1));
    } else {
      EXPECT_THAT(followed, testing::SizeIs(2)) << "two for long are two, of whom one is hidden";
    }
  }
}

TEST(TrackPeople, WhoComesBackAndLooksTheSameHasTheOldId) {
  Follower follower;
  Actor red, blue;
  blue.colour = {30, 30, 200};
  blue.trunk.x() = 0.8F;
  follower.show({red, blue}, 30);
  follower.show(std::vector<Actor>{}, 200);
  Actor green;
  green.colour = {30, 200, 30};
  follower.show({green}, 10);
  follower.show(std::vector<Actor>{}, 200);
  blue.trunk.x() = -0.5F;
  const TrackedFrame back = follower.show({blue});
  ASSERT_EQ(back.people.size(), 1U);
  EXPECT_EQ(back.people[0].id, 2) << "at once, since ids never change";
  EXPECT_EQ(follower.show({blue, red}).people.at(0).id, 1);
  EXPECT_EQ(follower.ids[0].count(3), 1U) << "green was somebody else";
}

TEST(TrackPeople, TwoWhoLookAlikeAreNotTakenForEachOtherOnceBothAreGone) {
  Follower follower;
  Actor left, right;
  left.trunk.x() = -0.6F;
  right.trunk.x() = 0.6F;
  follower.show({left, right}, 30);
  follower.show(std::vector<Actor>{}, 200);
  EXPECT_EQ(follower.show({left}).people.at(0).id, 3) << "nobody can say which of the two";
}

TEST(TrackPeople, IdsHoldWherePeopleCross) {
  for (const bool alike : {false, true}) {
    Follower follower;
    Actor front, behind;
    front.trunk.z() = 2.F;
    behind.trunk.z() = 3.F;
    if (!alike) behind.colour = {30, 30, 200};
    for (int i = 0; i < 90; ++i) {
      front.trunk.x() = -0.9F + 0.6F * static_cast<float>(i * kFrame_s);
      behind.trunk.x() = 1.2F - 0.8F * static_cast<float>(i * kFrame_s);
      follower.show({front, behind});
    }
    EXPECT_THAT(follower.ids[0], testing::SizeIs(1)) << alike;
    EXPECT_THAT(follower.ids[1], testing::SizeIs(1)) << alike;
    EXPECT_NE(*follower.ids[0].begin(), *follower.ids[1].begin());
  }
}

TEST(TrackPeople, LookDecidesWherePlaceCannot) {
  // Both vanish, and are back after a second on each other's side.
  Follower follower;
  Actor red, blue;
  blue.colour = {30, 30, 200};
  red.trunk.x() = -0.5F;
  blue.trunk.x() = 0.5F;
  follower.show({red, blue}, 30);
  follower.show(std::vector<Actor>{}, 30);
  std::swap(red.trunk, blue.trunk);
  follower.show({red, blue}, 5);
  EXPECT_THAT(follower.ids[0], testing::ElementsAre(1));
  EXPECT_THAT(follower.ids[1], testing::ElementsAre(2));
}

TEST(TrackPeople, IdsHoldForWhoWalksAboutWithMissingFrames) {
  Random random(5);
  Follower follower;
  const std::vector<Rgb> colours{{200, 30, 30}, {30, 200, 30}, {30, 30, 200}, {200, 200, 30}};
  std::vector<Actor> actors(4);
  std::vector<float> phase(4), depth{2.F, 2.6F, 3.2F, 3.8F};
  for (std::size_t i = 0; i < 4; ++i) {
    actors[i].colour = colours[i];
    phase[i] = static_cast<float>(random.uniform(0.0, 6.28));
  }
  for (int frame = 0; frame < 450; ++frame) {
    const auto t = static_cast<float>(frame * kFrame_s);
    for (std::size_t i = 0; i < 4; ++i) {
      const float noise = static_cast<float>(random.normal(0.0, 0.02));
      actors[i].trunk = {0.7F * std::sin(t * (0.7F + 0.15F * static_cast<float>(i)) + phase[i]) + noise, 0.F, depth[i]};
      actors[i].found = random.uniform() > 0.25;
    }
    follower.show(actors);
  }
  std::set<int> all;
  for (const auto& [actor, ids] : follower.ids) {
    EXPECT_THAT(ids, testing::SizeIs(1)) << "actor " << actor;
    all.insert(ids.begin(), ids.end());
  }
  EXPECT_EQ(all.size(), 4U);
}

TEST(TrackPeople, TheOrderOfTheListDoesNotMatter) {
  Random random(6);
  PeopleTracker sorted(paper_body(), {}, hue()), shuffled(paper_body(), {}, hue());
  for (int frame = 0; frame < 40; ++frame) {
    std::vector<Actor> actors(5);
    for (Actor& actor : actors) {
      actor.trunk = {static_cast<float>(random.uniform(-1.0, 1.0)), 0.F, static_cast<float>(random.uniform(2.0, 4.0))};
      actor.score = static_cast<float>(random.uniform(0.5, 1.0));
    }
    Stage stage(actors);
    std::vector<Person> other = stage.people;
    for (std::size_t i = other.size(); i > 1; --i) {
      std::swap(other[i - 1], other[random.below(static_cast<std::uint32_t>(i))]);
    }
    const TrackedFrame a = sorted.update(stage.frame, {stage.people}), b = shuffled.update(stage.frame, {other});
    ASSERT_EQ(a.people.size(), b.people.size());
    for (std::size_t i = 0; i < a.people.size(); ++i) {
      EXPECT_EQ(a.people[i].id, b.people[i].id);
      EXPECT_EQ(a.people[i].state, b.people[i].state);
      EXPECT_EQ(a.people[i].position, b.people[i].position);
      EXPECT_EQ(a.people[i].person.mask, b.people[i].person.mask);
    }
  }
}

TEST(Expect, MovesTheMaskWithThePerson) {
  Follower follower;
  Actor walker;
  for (int i = 0; i < 30; ++i) {
    walker.trunk.x() = -0.8F + 1.2F * static_cast<float>(i * kFrame_s);
    follower.show({walker});
  }
  walker.trunk.x() += 1.2F * 0.1F;  // three frames later
  Stage stage({walker});
  stage.frame.time_s = 29 * kFrame_s + 0.1;
  const Prior prior = follower.tracker.expect(stage.frame);
  ASSERT_EQ(prior.people.size(), 1U);
  const Mask &expected = prior.people[0].mask, &is = stage.people[0].mask;
  long both = 0, either = 0;
  for (std::size_t i = 0; i < is.size(); ++i) {
    both += expected[i] != 0 && is[i] != 0 ? 1 : 0;
    either += expected[i] != 0 || is[i] != 0 ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(both), 0.85 * static_cast<double>(either));
  EXPECT_GT(prior.people[0].odds, 10.F);
  EXPECT_GT(prior.people[0].appearance.samples(), 100);
  EXPECT_EQ(follower.tracker.expect(stage.frame).people[0].mask, expected) << "asking changes nothing";
}

TEST(Expect, NobodyInAPlaceThatIsEmptyOrHidden) {
  Follower follower;
  follower.show({Actor{}}, 10);
  EXPECT_TRUE(follower.tracker.expect(Stage({}).frame).people.empty()) << "one sees the wall";
  Actor before;
  before.trunk.z() = 1.5F;
  EXPECT_TRUE(follower.tracker.expect(Stage({before}).frame).people.empty()) << "somebody else is in front";
  Frame later = Stage({Actor{}}).frame;
  later.time_s = 2.0;
  EXPECT_TRUE(follower.tracker.expect(later).people.empty()) << "too long ago";
}

TEST(Expect, AGuessHasNoOdds) {
  Follower follower;
  follower.show({Actor{}});
  const Prior prior = follower.tracker.expect(Stage({Actor{}}).frame);
  ASSERT_EQ(prior.people.size(), 1U);
  EXPECT_EQ(prior.people[0].odds, 1.F);
}

TEST(Expect, WeakEvidenceDoesNotKeepSomebodyForEver) {
  Follower follower;
  Actor coat;
  follower.show({coat}, 60);
  const auto odds = [&] {
    Frame next = Stage({coat}).frame;
    return follower.tracker.expect(next).people.at(0).odds;
  };
  const float before = odds();
  coat.score = 0.3F;
  follower.show({coat}, 15);
  EXPECT_LT(odds(), before);
  follower.show({coat}, 60);
  EXPECT_EQ(odds(), 1.F) << "then a score must be as high as anybody's";
}

TEST(Expect, AGhostIsGivenUpSoon) {
  // A detector that accepts whatever reaches 0.8 with the tracker's odds sees a coat that looks a little like a person.
  for (const float score : {0.3F, 0.4F}) {
    Follower follower;
    Actor coat;
    follower.show({coat}, 60);
    coat.score = score;
    int accepted = 0;
    for (int i = 0; i < 300; ++i) {
      const Prior prior = follower.tracker.expect(Stage({coat}).frame);
      const float odds = prior.people.empty() ? 1.F : prior.people[0].odds;
      coat.found = odds * score / (1.F - score) >= 4.F;
      accepted += coat.found ? 1 : 0;
      follower.show({coat});
    }
    EXPECT_LE(accepted, 45) << score;
  }
}

TEST(TrackedTime, OfSourcesWithoutTimesFollowsFromTheRate) {
  TrackOptions options;
  options.rate = 10.F;
  PeopleTracker tracker(paper_body(), options);
  const Stage stage({Actor{}});
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(tracker.update(stage.frame, {stage.people}).time_s, 0.1 * i, 1e-9);
}

TEST(TrackedTime, ThatJumpsLosesAllButRemembersLooks) {
  for (const double jump : {-1.0, 3600.0, 1e300, -1e300}) {
    PeopleTracker tracker(paper_body(), {}, hue());
    Stage stage({Actor{}});
    for (int i = 0; i < 10; ++i) {
      stage.frame.time_s = 100.0 + i * kFrame_s;
      tracker.update(stage.frame, {stage.people});
    }
    stage.frame.time_s = 100.0 + jump;
    EXPECT_TRUE(tracker.expect(stage.frame).people.empty());
    const TrackedFrame after = tracker.update(stage.frame, {});
    ASSERT_EQ(after.people.size(), 1U) << jump;
    EXPECT_EQ(after.people[0].state, TrackState::lost);
    *stage.frame.time_s += kFrame_s;
    EXPECT_EQ(tracker.update(stage.frame, {stage.people}).people.at(0).id, 1);
  }
}

TEST(TrackedTime, OfAFrameThatComesLateLosesNobody) {
  PeopleTracker tracker(paper_body(), {}, hue());
  Stage stage({Actor{}});
  double last_s = 0.0;
  for (const int place : {0, 1, 2, 3, 5, 4, 6, 7, 9, 8, 10, 11}) {
    stage.frame.time_s = 100.0 + place * kFrame_s;
    const bool expected = !tracker.expect(stage.frame).people.empty();
    EXPECT_EQ(expected, place != 0) << place;
    const TrackedFrame tracked = tracker.update(stage.frame, {stage.people});
    ASSERT_EQ(tracked.people.size(), 1U) << place;
    EXPECT_EQ(tracked.people[0].id, 1);
    EXPECT_NE(tracked.people[0].state, TrackState::lost);
    EXPECT_GE(tracked.time_s, last_s) << "times of what is told rise";
    last_s = tracked.time_s;
  }
  EXPECT_NEAR(last_s, 100.0 + 11 * kFrame_s, 1e-9) << "none of the late frames counts";
}

TEST(TrackedTime, OfAClockSetBackALittleGoesOn) {
  PeopleTracker tracker(paper_body(), {}, hue());
  Stage stage({Actor{}});
  TrackedFrame tracked;
  for (int i = 0; i < 60; ++i) {
    stage.frame.time_s = 100.0 + i * kFrame_s - (i < 30 ? 0.0 : 0.8);
    tracked = tracker.update(stage.frame, {stage.people});
    ASSERT_EQ(tracked.people.size(), 1U) << i;
    ASSERT_EQ(tracked.people[0].id, 1);
  }
  EXPECT_NEAR(tracked.time_s, 100.0 + 58 * kFrame_s, 1e-9) << "only the step back takes no time";
}

TEST(TrackedTime, ThatStandsStillOrIsNonsenseIsBorne) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  PeopleTracker tracker(paper_body(), {}, hue());
  Stage stage({Actor{}});
  const std::vector<std::optional<double>> times{1.0, 1.0, 1.0, kNaN, kInfinity, -kInfinity, std::nullopt, 1.2, 1.2};
  for (const std::optional<double>& time : times) {
    stage.frame.time_s = time;
    tracker.expect(stage.frame);
    const TrackedFrame tracked = tracker.update(stage.frame, {stage.people});
    EXPECT_TRUE(std::isfinite(tracked.time_s));
    ASSERT_EQ(tracked.people.size(), 1U);
    EXPECT_EQ(tracked.people[0].id, 1);
    EXPECT_TRUE(tracked.people[0].position.allFinite());
    EXPECT_TRUE(tracked.people[0].velocity.allFinite());
  }
}

TEST(TrackPeople, FramesOfAnotherSizeGoOn) {
  PeopleTracker tracker(paper_body(), {}, hue());
  const Camera half{80, 60, 65.5F, 65.5F, 39.5F, 29.5F};
  for (int i = 0; i < 12; ++i) {
    const Stage stage({Actor{}}, i / 4 == 1 ? half : kCamera);
    for (const Prior::KnownPerson& known : tracker.expect(stage.frame).people) {
      EXPECT_TRUE(known.mask.same_size(stage.frame.depth));
    }
    const TrackedFrame tracked = tracker.update(stage.frame, {stage.people});
    ASSERT_EQ(tracked.people.size(), 1U);
    EXPECT_EQ(tracked.people[0].id, 1);
  }
  const Stage small({Actor{}}, half);
  const TrackedFrame tracked = tracker.update(Stage({Actor{}}).frame, {small.people});
  ASSERT_EQ(tracked.people.size(), 1U) << "by the parts";
  EXPECT_TRUE(tracked.people[0].person.mask.empty());
}

TEST(TrackPeople, APersonOfTwoPixelsOrOfNothing) {
  PeopleTracker tracker(paper_body(), {}, hue());
  Stage stage({Actor{}});
  Person two = stage.people[0];
  two.skeleton = {};
  two.skeleton.parts.resize(paper_body().parts.size());
  two.joints = derive_joints(paper_body(), two.skeleton);
  two.mask.fill(0);
  two.mask(80, 60) = two.mask(81, 60) = 1;
  Person nothing = two;
  nothing.mask.fill(0);
  Person nan = stage.people[0];
  for (SkeletonPart& part : nan.skeleton.parts) part.centre.setConstant(std::numeric_limits<float>::quiet_NaN());
  nan.score = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 20; ++i) {
    tracker.expect(stage.frame);
    const TrackedFrame tracked = tracker.update(stage.frame, {{two, nothing, nan}});
    EXPECT_LE(tracked.people.size(), 2U);
    for (const TrackedPerson& person : tracked.people) EXPECT_TRUE(person.position.allFinite());
  }
}

TEST(TrackPeople, RefusesPeopleOfAnotherBodyAndOptionsOutOfRange) {
  PeopleTracker tracker(paper_body());
  Stage stage({Actor{}});
  stage.people[0].skeleton.parts.pop_back();
  EXPECT_THAT([&] { tracker.update(stage.frame, {stage.people}); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("24 parts")));
  stage.people[0].skeleton.parts.emplace_back();
  stage.people[0].skeleton.voted.resize(3);
  EXPECT_THAT([&] { tracker.update(stage.frame, {stage.people}); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("3 voted ones")));
  TrackOptions options;
  options.rate = 0.F;
  EXPECT_THROW(PeopleTracker(paper_body(), options), UsageError);
}

TEST(TrackPeople, AHundredFalseOnesAFrameAreBorne) {
  const Camera tiny{8, 6, 6.5F, 6.5F, 3.5F, 2.5F};
  const Stage stage({Actor{}}, tiny);
  Random random(7);
  PeopleTracker tracker(paper_body(), {}, hue());
  for (int frame = 0; frame < 60; ++frame) {
    std::vector<Person> people(100, stage.people[0]);
    for (Person& person : people) {
      const auto far = [&] { return static_cast<float>(random.uniform(-30.0, 30.0)); };
      const float x = far(), y = far(), z = 35.F + far();
      for (SkeletonPart& part : person.skeleton.parts) part.centre += Vector3f(x, y, z);
      person.score = static_cast<float>(random.uniform());
    }
    EXPECT_LE(tracker.expect(stage.frame).people.size(), 16U);
    const TrackedFrame tracked = tracker.update(stage.frame, {std::move(people)});
    EXPECT_LE(tracked.people.size(), 2U * 128U);
  }
}

TEST(TrackPeople, HoursOfPassersByAreForgotten) {
  // Whoever is lost is kept up to a number; ids go on.
  TrackOptions options;
  options.remembered = 4;
  options.hidden_s = 0.1F;
  PeopleTracker tracker(paper_body(), options);
  const Camera tiny{8, 6, 6.5F, 6.5F, 3.5F, 2.5F};
  Stage there({Actor{}}, tiny), empty({}, tiny);
  std::set<int> ids;
  std::size_t most = 0;
  long frames = 0;
  for (int passer = 0; passer < 5000; ++passer) {
    for (int i = 0; i < 20; ++i) {
      Stage& stage = i < 5 ? there : empty;
      stage.frame.time_s = static_cast<double>(frames++) * kFrame_s;
      const TrackedFrame tracked = tracker.update(stage.frame, {stage.people});
      most = std::max(most, tracked.people.size());
      for (const TrackedPerson& person : tracked.people) ids.insert(person.id);
    }
  }
  EXPECT_EQ(most, 1U);
  EXPECT_EQ(ids.size(), 5000U) << "without looks nobody is known again, and no id is used twice";
}

/// A person of capsules with true labels and places of the parts.
std::pair<Frame, Person> rendered_person() {
  CapsuleScene scene;
  scene.people.emplace_back();
  const LabelledFrame truth = render(scene, kCamera, paper_body());
  Person person;
  person.score = 0.95F;
  person.labels = truth.labels;
  person.mask = Mask(kCamera.width, kCamera.height, 0);
  for (std::size_t i = 0; i < person.mask.size(); ++i) person.mask[i] = truth.person[i] == 0 ? 1 : 0;
  for (int v = 0; v < kCamera.height; v += 2) {
    for (int u = 0; u < kCamera.width; u += 2) {
      if (person.mask(u, v) == 0) continue;
      const Vector3f at = point_at(kCamera, truth.frame.depth, u, v);
      person.points.push_back({at, {truth.labels(u, v), kBackground, kBackground}, {1.F, 0.F, 0.F}});
    }
  }
  for (const Vector3f& centre : truth.parts[0]) {
    SkeletonPart& part = person.skeleton.parts.emplace_back();
    part.state = State::observed;
    part.centre = centre;
    part.confidence = 0.8F;
    ++person.skeleton.found;
  }
  person.joints = derive_joints(paper_body(), person.skeleton);
  return {truth.frame, person};
}

TEST(TrackPeople, HaveABodyThatFadesWhileTheyAreHidden) {
  const auto [frame, person] = rendered_person();
  PeopleTracker tracker(paper_body(), {}, nullptr, std::make_shared<BodyFitter>(paper_body()));
  TrackedFrame tracked;
  for (int i = 0; i < 4; ++i) tracked = tracker.update(frame, {{person}});
  ASSERT_EQ(tracked.people.size(), 1U);
  ASSERT_TRUE(tracked.people[0].body);
  const FittedBody seen = *tracked.people[0].body;
  EXPECT_NEAR(seen.stature_m, CapsuleBuild().stature_m, 0.25F);
  tracked = tracker.update(frame, {});
  ASSERT_EQ(tracked.people.at(0).state, TrackState::hidden);
  ASSERT_TRUE(tracked.people[0].body);
  EXPECT_TRUE(tracked.people[0].person.points.empty());
  const FittedBody& hidden = *tracked.people[0].body;
  ASSERT_EQ(hidden.bones.size(), seen.bones.size());
  EXPECT_EQ(hidden.stature_m, seen.stature_m);
  for (std::size_t i = 0; i < seen.bones.size(); ++i) {
    if (seen.bones[i].state == State::none) continue;
    EXPECT_EQ(hidden.bones[i].state, State::predicted);
    EXPECT_LT(hidden.bones[i].confidence, seen.bones[i].confidence);
    EXPECT_LT(hidden.bones[i].tail_confidence, seen.bones[i].tail_confidence);
    EXPECT_GT(hidden.bones[i].covariance.trace(), seen.bones[i].covariance.trace());
  }
}

TEST(TrackPeople, ExpectTheSizeOfTheFittedBodyOnceItHasSettled) {
  const auto [frame, person] = rendered_person();
  PeopleTracker tracker(paper_body(), {}, nullptr, std::make_shared<BodyFitter>(paper_body()));
  TrackedFrame tracked;
  for (int i = 0; i < BodyHistory::kSettledFrames; ++i) {
    const Prior prior = tracker.expect(frame);
    for (const Prior::KnownPerson& known : prior.people) EXPECT_EQ(known.size, 1.F);
    tracked = tracker.update(frame, {{person}});
  }
  const FleshModel& flesh = builtin_flesh();
  const double usual_m = stature(flesh, Eigen::VectorXd::Zero(flesh.shapes));
  const Prior prior = tracker.expect(frame);
  ASSERT_EQ(prior.people.size(), 1U);
  EXPECT_NE(prior.people[0].size, 1.F);
  EXPECT_NEAR(prior.people[0].size, tracked.people.at(0).body.value().stature_m / usual_m, 0.03);
}

TEST(TrackPeople, SmoothsUnlessItShallNot) {
  TrackOptions options;
  options.smooth = false;
  Follower plain(options);
  EXPECT_TRUE(plain.show({Actor{}}).people.at(0).smoothed.empty());
  Follower follower;
  follower.show({Actor{}}, 5);
  const TrackedPerson person = follower.show({Actor{}}).people.at(0);
  ASSERT_EQ(person.smoothed.size(), person.person.joints.size());
}

TEST(TrackPeople, TellsTheFloorAndWhoStandsOnIt) {
  PeopleTracker tracker(paper_body());
  Stage stage({Actor{}});
  std::vector<StanceEvent> events;
  for (int i = 0; i < 60; ++i) {
    // The hips are 0.2 m below the camera, the head's parts 0.55 m above it.
    const TrackedFrame tracked = tracker.update(stage.frame, {stage.people, {{Vector3f::UnitY(), 1.1F, 4.F}}});
    events.insert(events.end(), tracked.events.begin(), tracked.events.end());
    if (i == 59) {
      ASSERT_TRUE(tracked.floor);
      EXPECT_NEAR(tracked.floor->height_m, 1.1F, 1e-4F);
      EXPECT_EQ(tracked.people.at(0).stance, Stance::standing);
    }
  }
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].id, 1);
  EXPECT_EQ(events[0].stance, Stance::standing);
  EXPECT_EQ(events[0].before, Stance::unknown);
}

TEST(TrackPeople, WhoFallsIsToldByThePixelsThatStayThoughNotFound) {
  for (const bool piece : {false, true}) {
    SCOPED_TRACE(piece ? "a piece of somebody else" : "alone");
    PeopleTracker tracker(paper_body(), {}, hue());
    std::vector<Stance> told;
    double time_s = 0.0;
    Actor upright, falls;
    upright.trunk.x() = -1.2F;
    upright.colour = {30, 30, 200};
    Mask of_falls;
    const auto show = [&](int frames) {
      TrackedFrame tracked;
      for (int i = 0; i < frames; ++i, time_s += kFrame_s) {
        Stage stage({upright, falls});
        stage.frame.time_s = time_s;
        if (falls.found) {
          of_falls = stage.people.at(1).mask;
        } else if (piece) {
          Mask& larger = stage.people.at(0).mask;
          for (std::size_t p = 0; p < larger.size(); ++p) larger[p] |= of_falls[p];
        }
        tracked = tracker.update(stage.frame, {stage.people, {{Vector3f::UnitY(), 1.F, 4.F}}});
        for (const StanceEvent& event : tracked.events) {
          if (event.id == 2) told.push_back(event.stance);
        }
      }
      return tracked.people.at(1);
    };
    show(60);
    falls.lies = true;
    for (int i = 0; i < 8; ++i) {
      falls.trunk.y() += 0.1F;
      show(1);
    }
    show(2);
    falls.found = false;
    const TrackedPerson hidden = show(60);
    EXPECT_EQ(hidden.id, 2);
    EXPECT_EQ(hidden.state, TrackState::hidden);
    if (piece) {
      EXPECT_FALSE(hidden.posture);
      EXPECT_EQ(told, std::vector{Stance::standing});
      continue;
    }
    EXPECT_EQ(hidden.stance, Stance::fallen);
    ASSERT_TRUE(hidden.posture && hidden.posture->top_m);
    EXPECT_NEAR(*hidden.posture->top_m, 0.2F + 0.22F, 0.03F);
    EXPECT_FALSE(hidden.posture->chest_m);
    EXPECT_EQ(told, (std::vector{Stance::standing, Stance::fallen}));
  }
}

TEST(TrackPeople, WhoIsNearTheFloorIsFollowedWhileSomethingIsThere) {
  const TrackOptions options;
  const std::vector<Plane> low{{Vector3f::UnitY(), 0.3F, 4.F}}, high{{Vector3f::UnitY(), 1.1F, 4.F}};
  Actor unseen;
  unseen.found = false;
  Actor other;
  other.trunk.x() = 0.7F;
  other.colour = {30, 30, 200};
  struct Case {
    const char* what;
    const std::vector<Plane>& planes;
    std::vector<Actor> after;
    double gone_s;  ///< after not having been found any more
  };
  const double hidden_s = static_cast<double>(options.hidden_s), down_s = static_cast<double>(options.down_s);
  for (const Case& each : {Case{"down", low, {unseen}, down_s}, Case{"upright", high, {unseen}, hidden_s},
                           Case{"gone", low, {}, hidden_s}, Case{"found anew", low, {unseen, other}, hidden_s}}) {
    SCOPED_TRACE(each.what);
    PeopleTracker tracker(paper_body(), options, hue());
    double time_s = 0.0;
    const auto show = [&](const std::vector<Actor>& actors) {
      Stage stage(actors);
      stage.frame.time_s = time_s;
      return tracker.update(stage.frame, {stage.people, each.planes});
    };
    for (int i = 0; i < 30; ++i, time_s += 0.1) ASSERT_EQ(show({Actor{}}).people.front().id, 1);
    const double last_s = time_s - 0.1;
    std::optional<double> lost_s;
    for (int i = 0; i < 320 && !lost_s; ++i, time_s += 0.1) {
      for (const TrackedPerson& person : show(each.after).people) {
        if (person.id == 1 && person.state == TrackState::lost) lost_s = time_s - last_s;
      }
    }
    ASSERT_TRUE(lost_s);
    EXPECT_NEAR(*lost_s, each.gone_s, 0.15);
  }
}

TEST(TrackPeople, TellWhoStandsByTheFittedBodyWhereNoHipsAreSeen) {
  auto [frame, person] = rendered_person();
  const BodyModel& body = paper_body();
  float lowest_m = 0.F;  // the y axis points down
  for (std::size_t p = 0; p < body.parts.size(); ++p) {
    SkeletonPart& part = person.skeleton.parts[p];
    lowest_m = std::max(lowest_m, part.centre.y());
    if (body.parts[p].name.ends_with("hips")) part.state = State::predicted;
  }
  const Plane floor{Vector3f::UnitY(), lowest_m + 0.05F, 4.F};
  for (const bool fits : {false, true}) {
    PeopleTracker tracker(body, {}, nullptr, fits ? std::make_shared<BodyFitter>(body) : nullptr);
    TrackedFrame tracked;
    for (int i = 0; i < 40; ++i) tracked = tracker.update(frame, {{person}, {floor}});
    ASSERT_EQ(tracked.people.size(), 1U);
    EXPECT_EQ(tracked.people[0].stance, fits ? Stance::standing : Stance::unknown);
  }
}

/// Somebody who is surely found, in a picture that is large enough for a part of it to matter.
class PartOfThePicture : public testing::Test {
 protected:
  PartOfThePicture() { somebody_.score = 0.99F; }

  std::optional<PictureRegion> region(const std::vector<Actor>& actors, double time_s) {
    Stage stage(actors);
    stage.frame.time_s = time_s;
    return tracker_.region(stage.frame);
  }
  void show(const std::vector<Actor>& actors, double time_s, bool whole = true) {
    Stage stage(actors);
    stage.frame.time_s = time_s;
    tracker_.update(stage.frame, {stage.people, planes_, whole});
  }

  Actor somebody_;
  std::vector<Plane> planes_{{Vector3f::UnitZ(), kWall_m, 8.F}};
  PeopleTracker tracker_{paper_body(), {}, hue()};
};

TEST_F(PartOfThePicture, IsWherePeopleWillBe) {
  EXPECT_FALSE(region({somebody_}, 0.0)) << "nothing is known";
  show({somebody_}, 0.0);
  const std::optional<PictureRegion> around = region({somebody_}, kFrame_s);
  ASSERT_TRUE(around);
  EXPECT_EQ(around->planes.size(), 1U);
  const Box own = bounding_box(Stage({somebody_}).people[0].mask), &box = around->box;
  EXPECT_LT(box.u, own.u - 3);
  EXPECT_GT(box.u + box.width, own.u + own.width + 3);
  EXPECT_LT(box.width, 2 * own.width);
  EXPECT_GE(box.width, own.width + own.width / 3);
  EXPECT_GE(box.v, 0);
  EXPECT_LE(box.v + box.height, kCamera.height);
  // Somebody who walks is looked for where the way goes on.
  Actor walks = somebody_;
  for (int i = 1; i < 15; ++i) {
    walks.trunk.x() += 0.06F;
    show({walks}, i * kFrame_s);
  }
  const Box last = bounding_box(Stage({walks}).people[0].mask);
  const std::optional<PictureRegion> ahead = region({walks}, 15 * kFrame_s);
  ASSERT_TRUE(ahead);
  EXPECT_GT(ahead->box.u + ahead->box.width - (last.u + last.width), last.u - ahead->box.u + 2);
}

TEST_F(PartOfThePicture, IsTheWholeOneNowAndThen) {
  show({somebody_}, 0.0);
  for (int i = 1; i <= 5; ++i) {
    ASSERT_TRUE(region({somebody_}, i * kFrame_s)) << i;
    show({somebody_}, i * kFrame_s, false);
  }
  EXPECT_FALSE(region({somebody_}, 6 * kFrame_s)) << "0.17 s have passed";
  show({somebody_}, 6 * kFrame_s);
  EXPECT_TRUE(region({somebody_}, 7 * kFrame_s));
  EXPECT_FALSE(region({somebody_}, 100.0)) << "a jump of the clock";
}

TEST_F(PartOfThePicture, IsTheWholeOneWhereItIsNotSureThatNobodyElseIsThere) {
  EXPECT_FALSE(region({}, 0.0));
  show({}, 0.0);
  EXPECT_FALSE(region({}, kFrame_s)) << "nobody is followed";
  show({somebody_}, kFrame_s);
  Actor other = somebody_;
  other.trunk.x() = 1.2F;
  EXPECT_TRUE(region({somebody_}, 2 * kFrame_s));
  EXPECT_FALSE(region({somebody_, other}, 2 * kFrame_s)) << "somebody came in";
  Actor unseen = somebody_;
  unseen.found = false;
  show({unseen}, 2 * kFrame_s);
  EXPECT_FALSE(region({somebody_}, 3 * kFrame_s)) << "somebody was not found";
  Actor doubtful = somebody_;
  doubtful.score = 0.85F;
  show({doubtful}, 3 * kFrame_s);
  EXPECT_FALSE(region({somebody_}, 4 * kFrame_s));
  Actor far_left = somebody_, far_right = somebody_;
  far_left.trunk.x() = -1.2F, far_right.trunk.x() = 1.2F;
  show({far_left, far_right}, 4 * kFrame_s);
  EXPECT_FALSE(region({far_left, far_right}, 5 * kFrame_s)) << "there is nothing to gain";
}

TEST_F(PartOfThePicture, IsNeverAskedForWithoutATime) {
  EXPECT_TRUE(tracker_.knows_regions());
  TrackOptions options;
  options.whole_s = 0.F;
  tracker_ = PeopleTracker(paper_body(), options, hue());
  EXPECT_FALSE(tracker_.knows_regions());
  show({somebody_}, 0.0);
  EXPECT_FALSE(region({somebody_}, kFrame_s));
}

/// Returns the memory that this process has in use, if the system tells.
std::optional<double> resident_mib() {
  long pages = 0;
  std::ifstream statm("/proc/self/statm");
  if (!(statm >> pages >> pages)) return std::nullopt;
  return static_cast<double>(pages) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

/// What a camera may see over hours: people who come and go, false ones, times and sizes that are wrong.
class BadDay {
 public:
  BadDay() {
    const Camera wide{8, 6, 6.5F, 6.5F, 3.5F, 2.5F}, narrow{6, 8, 6.5F, 6.5F, 2.5F, 3.5F};
    Actor left, right;
    left.trunk.x() = -0.5F;
    right.trunk.x() = 0.6F;
    right.colour = {30, 30, 200};
    for (const std::vector<Actor>& actors : {std::vector<Actor>{}, {left}, {left, right}, {right}}) {
      stages_.emplace_back(actors, wide);
    }
    other_size_.emplace_back(std::vector<Actor>{left}, narrow);
  }

  /// Returns the next frame. Somebody comes, goes or changes the looks every second or two.
  const Frame& next(std::vector<Person>& people) {
    ++count_;
    if (count_ % 15 == 0) {
      scene_ = random_.below(4);
      shade_ = static_cast<std::uint8_t>(random_.below(256));
    }
    Stage& stage = count_ % 401 == 0 ? other_size_.front() : stages_[scene_];
    people = stage.people;
    if (count_ % 997 == 0) people = false_people(stages_[1].people.front());
    if (count_ % 211 == 0 && !people.empty()) people.front().mask.fill(0), people.front().mask[0] = 1;
    if (count_ % 30011 == 0) offset_s_ -= 7200.0;
    if (count_ % 40009 == 0) offset_s_ += 10800.0;
    if (count_ % 13 != 0) time_s_ = static_cast<double>(count_) * kFrame_s + offset_s_;  // otherwise twice the same
    stage.frame.time_s = count_ % 503 == 0 ? std::numeric_limits<double>::quiet_NaN() : time_s_;
    stage.frame.colour.fill({shade_, 90, static_cast<std::uint8_t>(255 - shade_)});
    return stage.frame;
  }

 private:
  std::vector<Person> false_people(const Person& like) {
    std::vector<Person> people(100, like);
    for (Person& person : people) {
      const float x = far(), y = far(), z = 35.F + far();
      for (SkeletonPart& part : person.skeleton.parts) part.centre += Vector3f(x, y, z);
      person.score = static_cast<float>(random_.uniform());
    }
    return people;
  }
  float far() { return static_cast<float>(random_.uniform(-30.0, 30.0)); }

  Random random_{9};
  std::vector<Stage> stages_, other_size_;
  std::uint32_t scene_ = 0;
  std::uint8_t shade_ = 0;
  long count_ = 0;
  double offset_s_ = 0.0, time_s_ = 0.0;
};

// Twelve minutes; VESALIUS_TRACK_HOURS=10 makes it ten hours, as every night.
TEST(TrackPeople, HoursOfBadInputNeedNoMoreMemory) {
  const char* asked = std::getenv("VESALIUS_TRACK_HOURS");
  const long updates = std::lround((asked != nullptr ? std::atof(asked) : 0.2) * 3600.0 / kFrame_s);
  ASSERT_GT(updates, 1000);
  PeopleTracker tracker(paper_body(), {}, hue());
  PeopleTracker fitting(paper_body(), {}, hue(), std::make_shared<BodyFitter>(paper_body()));
  const auto [room, somebody] = rendered_person();
  const Frame empty = Stage({}).frame;
  BadDay day;
  std::vector<Person> people;
  std::optional<double> warm_mib;
  std::size_t most = 0;
  int last_id = 0;
  for (long i = 0; i < updates; ++i) {
    const Frame& frame = day.next(people);
    ASSERT_LE(tracker.expect(frame).people.size(), 16U);
    const TrackedFrame tracked = tracker.update(frame, {std::move(people)});
    ASSERT_TRUE(std::isfinite(tracked.time_s));
    for (const TrackedPerson& person : tracked.people) {
      ASSERT_TRUE(person.position.allFinite());
      last_id = std::max(last_id, person.id);
    }
    most = std::max(most, tracked.people.size());
    if (i % 300 == 0) {  // fits take a thousand times as long
      fitting.update(i / 300 % 8 < 5 ? room : empty, {i / 300 % 8 < 5 ? std::vector{somebody} : std::vector<Person>()});
    }
    if (i == updates / 4) warm_mib = resident_mib();
  }
  EXPECT_GT(last_id, 100);
  EXPECT_LE(most, 2U * 128U);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (!warm_mib) GTEST_SKIP() << "the system does not tell memory";
  const double grown_mib = *resident_mib() - *warm_mib;
  RecordProperty("warm_mib", std::to_string(*warm_mib));
  RecordProperty("grown_mib", std::to_string(grown_mib));
  EXPECT_LT(grown_mib, 0.5) << "from " << *warm_mib << " MiB";
#endif
}

}  // namespace
}  // namespace vesalius
