#include "vesalius/merge/merge_people.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "vesalius/error.h"
#include "vesalius/merge/test_walkers.h"

namespace vesalius {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;
using testing::ElementsAre;

/// Two cameras about some people, one a quarter turn to the side.
class MergePeople : public testing::Test {
 protected:
  /// A walker whom a camera sees under an id, or expects there.
  struct Seen {
    int camera, who, id;
    TrackState state = TrackState::tracked;
  };

  /// Goes on to a time and returns everybody.
  TrackedFrame at(double time_s, const std::vector<Seen>& all) {
    std::vector<CameraPeople> seen(2);
    for (const Seen& one : all) {
      TrackedPerson person = test::seen_walker(walkers_[std::size_t(one.who)], float(time_s), one.id,
                                               poses_[std::size_t(one.camera)].inverse(), 0.02F, random_);
      person.state = one.state;
      person.stance = stance_;
      seen[std::size_t(one.camera)].people.people.push_back(std::move(person));
    }
    for (CameraPeople& camera : seen) camera.people.time_s = time_s;
    return merger_.merge(std::move(seen));
  }

  static std::vector<int> ids(const TrackedFrame& frame) {
    std::vector<int> ids;
    for (const TrackedPerson& person : frame.people) ids.push_back(person.id);
    return ids;
  }
  static float distance(const TrackedPerson& person, const test::Walker& walker, double time_s) {
    return (person.person.joints[0][8].position - test::joints_at(walker, float(time_s))[8]).norm();
  }

  std::vector<test::Walker> walkers_ = {{{-1.F, 0.F, 3.F}, {0.5F, 0.F, 0.F}}, {{1.F, 0.F, 3.6F}, {-0.5F, 0.F, 0.F}}};
  Random random_{9};
  const std::vector<Isometry3f> poses_ = {Isometry3f::Identity(), test::turned_about(90.F)};
  PeopleMerger merger_{poses_};
  Stance stance_ = Stance::unknown;
};

TEST_F(MergePeople, MakesOneListInTheFirstCamerasFrame) {
  for (int i = 0; i < 30; ++i) {
    const double time_s = i / 10.0;
    const TrackedFrame frame = at(time_s, {{0, 0, 3}, {0, 1, 4}, {1, 1, 7}, {1, 0, 9}});
    ASSERT_THAT(ids(frame), ElementsAre(1, 2)) << i;
    for (std::size_t p = 0; p < 2; ++p) {
      EXPECT_LT(distance(frame.people[p], walkers_[p], time_s), 0.08F);
      EXPECT_EQ(frame.people[p].state, TrackState::tracked);
      ASSERT_EQ(frame.people[p].seen_by.size(), 2U);
      EXPECT_EQ(frame.people[p].seen_by[1].camera, 1);
      EXPECT_EQ(frame.people[p].seen_by[1].id, p == 0 ? 9 : 7);
    }
  }
}

TEST_F(MergePeople, KeepsTheIdOfWhoeverOneCameraLoses) {
  (void)at(0.0, {{0, 0, 1}, {1, 0, 1}});
  (void)at(0.1, {{0, 0, 1}, {1, 0, 1}});
  TrackedFrame frame = at(0.2, {{0, 0, 1, TrackState::hidden}, {1, 0, 1}});
  EXPECT_THAT(ids(frame), ElementsAre(1));
  EXPECT_EQ(frame.people[0].state, TrackState::tracked);
  EXPECT_LT(distance(frame.people[0], walkers_[0], 0.2), 0.1F);
  // The first camera has given the person up, and finds somebody new later.
  for (int i = 3; i < 60; ++i) frame = at(i / 10.0, {{1, 0, 1}});
  frame = at(6.0, {{0, 0, 12}, {1, 0, 1}});
  EXPECT_THAT(ids(frame), ElementsAre(1));
  EXPECT_EQ(frame.people[0].seen_by.size(), 2U);
}

TEST_F(MergePeople, CorrectsACameraThatSwapsIds) {
  for (int i = 0; i < 20; ++i) (void)at(i / 10.0, {{0, 0, 1}, {0, 1, 2}, {1, 0, 1}, {1, 1, 2}});
  for (int i = 20; i < 40; ++i) {
    const TrackedFrame frame = at(i / 10.0, {{0, 1, 1}, {0, 0, 2}, {1, 0, 1}, {1, 1, 2}});
    ASSERT_THAT(ids(frame), ElementsAre(1, 2));
    if (std::abs(i - 20) > 3) {
      EXPECT_LT(distance(frame.people[0], walkers_[0], i / 10.0), 0.15F) << i;
    }
  }
}

TEST_F(MergePeople, IsHiddenOnlyWhereAllCamerasSaySo) {
  (void)at(0.0, {{0, 0, 1}, {1, 0, 1}});
  const TrackedFrame frame = at(0.1, {{0, 0, 1, TrackState::hidden}, {1, 0, 1, TrackState::hidden}});
  ASSERT_EQ(frame.people.size(), 1U);
  EXPECT_EQ(frame.people[0].state, TrackState::hidden);
  EXPECT_NEAR(frame.people[0].seen_s, 0.0, 1e-9);
}

TEST_F(MergePeople, TellsOfALossOnceAndKnowsWhoComesBack) {
  (void)at(0.0, {{0, 0, 1}, {1, 0, 5}, {1, 1, 6}});
  TrackedFrame frame = at(0.1, {{1, 1, 6}});
  ASSERT_THAT(ids(frame), ElementsAre(1, 2));
  EXPECT_EQ(frame.people[0].state, TrackState::lost);
  EXPECT_TRUE(frame.people[0].seen_by.empty());
  frame = at(0.2, {{1, 1, 6}});
  EXPECT_THAT(ids(frame), ElementsAre(2));
  // A camera that knows somebody again, by their looks, gives the old id.
  frame = at(30.0, {{1, 1, 6}, {1, 0, 5}});
  EXPECT_THAT(ids(frame), ElementsAre(1, 2));
  frame = at(30.1, {{1, 1, 6}, {0, 0, 8}, {1, 0, 5}});
  EXPECT_THAT(ids(frame), ElementsAre(1, 2));
}

TEST_F(MergePeople, AGuessIsNobodyUnlessAnotherCameraIsSure) {
  EXPECT_TRUE(at(0.0, {{0, 0, 1, TrackState::fresh}}).people.empty());
  const TrackedFrame frame = at(0.1, {{0, 0, 1, TrackState::fresh}, {1, 0, 1}});
  ASSERT_THAT(ids(frame), ElementsAre(1));
}

TEST_F(MergePeople, JoinsTwoWhoTurnOutToBeOne) {
  // As seen by the second camera somebody stands where nobody is, and walks into the one whom the first sees.
  walkers_[0] = {{0.F, 0.F, 3.F}, Vector3f::Zero()};
  walkers_[1] = {{1.5F, 0.F, 3.F}, {-1.F, 0.F, 0.F}};
  TrackedFrame frame = at(0.0, {{0, 0, 1}, {1, 1, 1}});
  EXPECT_THAT(ids(frame), ElementsAre(1, 2));
  for (int i = 1; i <= 14; ++i) frame = at(i / 10.0, {{0, 0, 1}, {1, 1, 1}});
  walkers_[1] = walkers_[0];
  for (int i = 15; i <= 30; ++i) frame = at(i / 10.0, {{0, 0, 1}, {1, 1, 1}});
  EXPECT_THAT(ids(frame), ElementsAre(1));
}

TEST_F(MergePeople, TellsOfStancesOnce) {
  (void)at(0.0, {{0, 0, 1}, {1, 0, 1}});
  stance_ = Stance::standing;
  TrackedFrame frame = at(0.1, {{0, 0, 1}, {1, 0, 1}});
  ASSERT_EQ(frame.events.size(), 1U);
  EXPECT_EQ(frame.events[0].id, 1);
  EXPECT_EQ(frame.events[0].stance, Stance::standing);
  EXPECT_TRUE(at(0.2, {{0, 0, 1}, {1, 0, 1}}).events.empty());
}

TEST_F(MergePeople, RefusesOtherNumbersOfCameras) { EXPECT_THROW(merger_.merge(std::vector<CameraPeople>(3)), Error); }

}  // namespace
}  // namespace vesalius
