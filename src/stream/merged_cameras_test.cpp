#include "stream/merged_cameras.h"

#include <gmock/gmock.h>

#include <memory>
#include <utility>

#include "stream/test_crossing.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// The crossing as a source that somebody owns, whose clock shows so much more.
class Borrowed : public FrameSource {
 public:
  Borrowed(test::Crossing& crossing, double clock_s) : crossing_(crossing), clock_s_(clock_s) {}
  std::optional<Frame> next() override {
    std::optional<Frame> frame = crossing_.next();
    if (frame) *frame->time_s += clock_s_;
    return frame;
  }
  int size() const override { return crossing_.size(); }
  std::optional<TimeSpan> span() const override { return TimeSpan{clock_s_, clock_s_ + crossing_.span()->last_s}; }
  void seek(double time_s) override { crossing_.seek(time_s - clock_s_); }

 private:
  test::Crossing& crossing_;
  double clock_s_;
};

class OtherCameras : public testing::Test {
 protected:
  OtherCamera camera(double clock_s) { return {std::make_unique<Borrowed>(crossing_, clock_s), detector_, {}}; }

  test::Crossing crossing_{true};
  const Detector detector_{std::make_shared<test::Knowing>(crossing_.frames())};
};

constexpr double kStep_s = 1.0 / kUsualRate;

TEST_F(OtherCameras, GiveTheFrameNearestToAMoment) {
  OtherCamera other = camera(0.0);
  CameraPeople seen = other.at(4.3 * kStep_s);
  EXPECT_NEAR(seen.people.time_s, 4 * kStep_s, 1e-9);
  EXPECT_NEAR(seen.behind_s, 0.3 * kStep_s, 1e-9);
  seen = other.at(4.6 * kStep_s);
  EXPECT_NEAR(seen.behind_s, -0.4 * kStep_s, 1e-9);
  EXPECT_EQ(seen.people.people.size(), 2U) << "all frames before were followed";
  EXPECT_EQ(seen.people.people[0].state, TrackState::tracked);
  seen = other.at(4.7 * kStep_s);
  EXPECT_NEAR(seen.people.time_s, 5 * kStep_s, 1e-9);
}

TEST_F(OtherCameras, SeeNobodyAfterTheirEnd) {
  OtherCamera other = camera(0.0);
  const double end_s = crossing_.span()->last_s;
  EXPECT_EQ(other.at(end_s + 0.2).people.people.size(), 2U);
  EXPECT_TRUE(other.at(end_s + 0.3).people.people.empty());
}

TEST_F(OtherCameras, BeginWithTheFirstIfTheirClocksCountFromOtherMoments) {
  OtherCamera other = camera(1.7e9);
  EXPECT_NEAR(other.at(0.0).behind_s, 0.0, 1e-6);
  EXPECT_NEAR(other.at(6 * kStep_s).behind_s, 0.0, 1e-6);
}

TEST_F(OtherCameras, KeepTheDifferenceOfClocksThatAreAlike) {
  OtherCamera other = camera(10.0);
  EXPECT_TRUE(other.at(0.0).people.people.empty()) << "it begins ten seconds later";
  EXPECT_EQ(other.at(10.0 + 8 * kStep_s).people.people.size(), 2U);
}

TEST_F(OtherCameras, GoBack) {
  OtherCamera other = camera(100.0);
  (void)other.at(100.0 + 20 * kStep_s);
  (void)other.at(100.0 + 23 * kStep_s);
  const CameraPeople seen = other.at(98.0);  // before its beginning: a second and more
  EXPECT_TRUE(seen.people.people.empty());
  EXPECT_EQ(other.at(100.0 + 10 * kStep_s).people.people.size(), 2U);
}

TEST(MergedCameras, ShowPeopleOfBothUnderOneId) {
  test::Crossing first(true), second(true);
  const Detector detector(std::make_shared<test::Knowing>(first.frames()));
  std::vector<OtherCamera> others;
  others.emplace_back(std::make_unique<Borrowed>(second, 0.0), detector, PeopleOptions{});
  MergedCameras cameras(detector.body(), std::move(others),
                        {Eigen::Isometry3f::Identity(), Eigen::Isometry3f::Identity()});
  PeopleTracker tracker = make_tracker(detector, {});
  TrackedFrame merged;
  while (const std::optional<Frame> frame = first.next()) {
    merged = cameras.merge(*frame, frame->time_s.value(), follow(detector, tracker, *frame));
  }
  ASSERT_EQ(merged.people.size(), 2U);
  EXPECT_EQ(merged.people[0].id, 1);
  EXPECT_EQ(merged.people[1].id, 2);
  EXPECT_EQ(merged.people[0].seen_by.size(), 2U);
  EXPECT_FALSE(merged.people[0].person.mask.empty());
  for (const Joint& joint : merged.people[0].person.joints[0]) {
    EXPECT_EQ(joint.unseen == Unseen::none, joint.state == State::observed);
  }
}

}  // namespace
}  // namespace vesalius
