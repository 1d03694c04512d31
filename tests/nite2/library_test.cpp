// libNiTE2.so as programs call it, on an OpenNI2 without a camera, beside the C++ tracker.

#include <NiteCAPI.h>
#include <fake_openni2.h>
#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "../standin/test_program.h"
#include "../standin/test_smoothing.h"
#include "io/files/test_files.h"
#include "io/sources/test_rooms.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"
#include "vesalius/track_people.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

// What programs were compiled with, on 64 bits.
static_assert(sizeof(NitePoint3f) == 12 && sizeof(NiteQuaternion) == 16 && offsetof(NiteQuaternion, w) == 12);
static_assert(sizeof(NiteSkeletonJoint) == 40 && offsetof(NiteSkeletonJoint, position) == 4 &&
              offsetof(NiteSkeletonJoint, positionConfidence) == 16 && offsetof(NiteSkeletonJoint, orientation) == 20 &&
              offsetof(NiteSkeletonJoint, orientationConfidence) == 36);
static_assert(sizeof(NiteSkeleton) == 604 && offsetof(NiteSkeleton, state) == 600);
static_assert(sizeof(NiteBoundingBox) == 24 && offsetof(NiteBoundingBox, max) == 12);
static_assert(sizeof(NitePoseData) == 8 && offsetof(NitePoseData, state) == 4);
static_assert(sizeof(NiteUserId) == 2 && sizeof(NiteHandId) == 2 && NiteUserId(-1) < 0);
static_assert(sizeof(NiteUserData) == 664 && offsetof(NiteUserData, id) == 0 &&
              offsetof(NiteUserData, boundingBox) == 4 && offsetof(NiteUserData, centerOfMass) == 28 &&
              offsetof(NiteUserData, state) == 40 && offsetof(NiteUserData, skeleton) == 44 &&
              offsetof(NiteUserData, poses) == 648);
static_assert(sizeof(NiteUserMap) == 24 && offsetof(NiteUserMap, pixels) == 0 && offsetof(NiteUserMap, width) == 8 &&
              offsetof(NiteUserMap, height) == 12 && offsetof(NiteUserMap, stride) == 16);
static_assert(sizeof(NitePlane) == 24 && offsetof(NitePlane, normal) == 12);
static_assert(sizeof(NiteUserTrackerFrame) == 88 && offsetof(NiteUserTrackerFrame, userCount) == 0 &&
              offsetof(NiteUserTrackerFrame, pUser) == 8 && offsetof(NiteUserTrackerFrame, userMap) == 16 &&
              offsetof(NiteUserTrackerFrame, pDepthFrame) == 40 && offsetof(NiteUserTrackerFrame, timestamp) == 48 &&
              offsetof(NiteUserTrackerFrame, frameIndex) == 56 &&
              offsetof(NiteUserTrackerFrame, floorConfidence) == 60 && offsetof(NiteUserTrackerFrame, floor) == 64);
static_assert(sizeof(NiteUserTrackerCallbacks) == 8 && sizeof(NiteHandTrackerCallbacks) == 8);
static_assert(sizeof(NiteHandData) == 20 && offsetof(NiteHandData, position) == 4 &&
              offsetof(NiteHandData, state) == 16);
static_assert(sizeof(NiteGestureData) == 20 && offsetof(NiteGestureData, currentPosition) == 4 &&
              offsetof(NiteGestureData, state) == 16);
static_assert(sizeof(NiteHandTrackerFrame) == 56 && offsetof(NiteHandTrackerFrame, pHands) == 8 &&
              offsetof(NiteHandTrackerFrame, gestureCount) == 16 && offsetof(NiteHandTrackerFrame, pGestures) == 24 &&
              offsetof(NiteHandTrackerFrame, pDepthFrame) == 32 && offsetof(NiteHandTrackerFrame, timestamp) == 40 &&
              offsetof(NiteHandTrackerFrame, frameIndex) == 48);
static_assert(sizeof(NiteVersion) == 16 && sizeof(NiteStatus) == 4 && NITE_STATUS_OUT_OF_FLOW == 3);
static_assert(NITE_JOINT_TORSO == 8 && NITE_JOINT_RIGHT_FOOT == 14 && NITE_SKELETON_TRACKED == 2 &&
              NITE_SKELETON_CALIBRATION_ERROR_TORSO == 7 && NITE_POSE_CROSSED_HANDS == 1 &&
              NITE_GESTURE_HAND_RAISE == 2);
static_assert(sizeof(OniFrame) == 80 && offsetof(OniFrame, data) == 8 && offsetof(OniFrame, timestamp) == 24 &&
              offsetof(OniFrame, frameIndex) == 32 && offsetof(OniFrame, width) == 36 &&
              offsetof(OniFrame, videoMode) == 44 && offsetof(OniFrame, croppingEnabled) == 60 &&
              offsetof(OniFrame, stride) == 72);

const std::string kData = std::string(VESALIUS_SOURCE_DIR) + "/data/";
const std::string kModel = kData + "models/default.model";
const std::string kQuickModel = kData + "models/capsule.forest";
constexpr std::uint64_t kStep_usec = 33'333;
/// Names in the model's joint set, in the interface's order.
constexpr std::array<const char*, NITE_JOINT_COUNT> kNames{"head",    "neck",   "l_shoulder", "r_shoulder", "l_elbow",
                                                           "r_elbow", "l_hand", "r_hand",     "torso",      "l_hip",
                                                           "r_hip",   "l_knee", "r_knee",     "l_foot",     "r_foot"};

/// A device of the fake, as an openni::Device holds it.
class Device {
 public:
  explicit Device(const FakeView& view) : view_(view) {
    EXPECT_EQ(oniDeviceOpen("a", &pointers_[1]), ONI_STATUS_OK);
    see(view);
  }
  ~Device() { oniDeviceClose(pointers_[1]); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void* object() { return pointers_.data(); }
  OniDeviceHandle handle() const { return pointers_[1]; }
  void see(const FakeView& view) {
    view_ = view;
    fake_set_view(handle(), &view);
  }
  const FakeView& view() const { return view_; }

  /// Gives a picture of depth.
  void push(const DepthImage& depth, std::uint64_t usec, OniPixelFormat format = ONI_PIXEL_FORMAT_DEPTH_1_MM,
            std::optional<std::pair<int, int>> crop = {}) {
    const int stride = depth.width() * 2 + 6;  // rows need not follow each other
    std::vector<char> bytes(static_cast<std::size_t>(stride * depth.height()));
    for (int v = 0; v < depth.height(); ++v) {
      std::memcpy(&bytes[static_cast<std::size_t>(v * stride)], depth.row(v),
                  static_cast<std::size_t>(depth.width()) * 2);
    }
    OniFrame frame{};
    frame.dataSize = int(bytes.size());
    frame.sensorType = ONI_SENSOR_DEPTH;
    frame.timestamp = usec;
    frame.frameIndex = ++pushed_;
    frame.width = depth.width();
    frame.height = depth.height();
    frame.videoMode = {format, view_.width, view_.height, 30};
    frame.stride = stride;
    if (crop) {
      frame.croppingEnabled = 1;
      std::tie(frame.cropOriginX, frame.cropOriginY) = *crop;
    }
    fake_push(handle(), &frame, bytes.data());
  }

 private:
  std::array<OniDeviceHandle, 2> pointers_{};
  FakeView view_;
  int pushed_ = 0;
};

/// The interface, begun with a model.
struct Nite {
  explicit Nite(const std::string& model = kQuickModel) {
    setenv("VESALIUS_MODEL", model.c_str(), 1);
    EXPECT_EQ(niteInitialize(), NITE_STATUS_OK);
  }
  ~Nite() {
    niteShutdown();
    unsetenv("VESALIUS_MODEL");
  }
};

struct ShutDown {
  void operator()(NiteUserTracker* tracker) const { EXPECT_EQ(niteShutdownUserTracker(tracker), NITE_STATUS_OK); }
};
using Tracker = std::unique_ptr<NiteUserTracker, ShutDown>;

struct Release {
  void operator()(NiteUserTrackerFrame* frame) const {
    EXPECT_EQ(niteUserTrackerFrameRelease(nullptr, frame), NITE_STATUS_OK);
  }
};
using Users = std::unique_ptr<NiteUserTrackerFrame, Release>;

Tracker tracker_on(Device& device) {
  NiteUserTrackerHandle made = nullptr;
  EXPECT_EQ(niteInitializeUserTrackerByDevice(device.object(), &made), NITE_STATUS_OK);
  return Tracker(made);
}

Users read(const Tracker& tracker) {
  NiteUserTrackerFrame* frame = nullptr;
  EXPECT_EQ(niteReadUserTrackerFrame(tracker.get(), &frame), NITE_STATUS_OK);
  return Users(frame);
}

/// A small forest is enough where only calls matter; small pictures too.
constexpr FakeView kQuickView{160, 120, 1.F, 0.8F, 0, 1};
DepthImage quick_wall() { return {160, 120, 3000}; }

DepthImage mirrored(DepthImage depth) {
  for (int v = 0; v < depth.height(); ++v) std::reverse(depth.row(v), depth.row(v) + depth.width());
  return depth;
}

FakeView view_of(const Camera& camera, bool is_mirrored) {
  const float across = 2.F * std::atan(float(camera.width) / (2.F * camera.fx));
  const float down = 2.F * std::atan(float(camera.height) / (2.F * camera.fy));
  return {camera.width, camera.height, across, down, is_mirrored ? 1 : 0, 1};
}

/// The camera of the picture that is mirrored back.
Camera camera_of(const FakeView& view) {
  const float half = float(view.width) / 2.F;
  return {view.width,
          view.height,
          float(view.width) / (2.F * std::tan(view.across_rad / 2.F)),
          float(view.height) / (2.F * std::tan(view.down_rad / 2.F)),
          view.mirrored != 0 ? float(view.width - 1) - half : half,
          float(view.height) / 2.F};
}

double seconds(std::uint64_t usec) { return double(usec) / 1e6; }

void expect_point(const NitePoint3f& point, const Eigen::Vector3f& metres, bool is_mirrored) {
  EXPECT_EQ(point.x, (is_mirrored ? -1000.F : 1000.F) * metres.x());
  EXPECT_EQ(point.y, -1000.F * metres.y());
  EXPECT_EQ(point.z, 1000.F * metres.z());
}

/// Expects what the C++ interface says of the joints. Returns how many have a place.
int expect_skeleton(const TrackedPerson& expected, const BodyModel& body, const NiteUserData& user, bool is_mirrored) {
  EXPECT_EQ(user.skeleton.state, NITE_SKELETON_TRACKED);
  const JointSet& set = body.joint_sets[find_joint_set(body, "nite15")];
  int placed = 0;
  for (std::size_t j = 0; j < kNames.size(); ++j) {
    const auto at = std::ranges::find(set.joints, kNames[j], &JointDefinition::name) - set.joints.begin();
    const Joint& joint = expected.person.joints[find_joint_set(body, "nite15")][static_cast<std::size_t>(at)];
    const NiteSkeletonJoint& theirs = user.skeleton.joints[j];
    EXPECT_EQ(theirs.jointType, j);
    EXPECT_EQ(theirs.positionConfidence, joint.state == State::none ? 0.F : joint.confidence) << kNames[j];
    if (joint.state == State::none) continue;
    expect_point(theirs.position, joint.position, is_mirrored);
    ++placed;
    const NiteQuaternion& q = theirs.orientation;
    EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1.F, 1e-3F);
    EXPECT_LE(theirs.orientationConfidence, theirs.positionConfidence);
  }
  return placed;
}

/// Expects the ids of the people by pixel.
void expect_map(const TrackedFrame& expected, const NiteUserMap& map, const FakeView& view) {
  ASSERT_EQ(map.width, view.width);
  ASSERT_EQ(map.height, view.height);
  ASSERT_EQ(map.stride, 2 * view.width);
  const auto indices = body_index_map(people_of(expected), view.width, view.height);
  long differing = 0;
  for (int v = 0; v < map.height; ++v) {
    for (int u = 0; u < map.width; ++u) {
      const std::uint8_t index = indices(view.mirrored != 0 ? map.width - 1 - u : u, v);
      const int id = index == kBackground ? 0 : expected.people[index].id;
      differing += map.pixels[v * map.width + u] != id ? 1 : 0;
    }
  }
  EXPECT_EQ(differing, 0);
}

/// The middle of a user's pixels is where the box and the centre say.
void expect_place(const NiteUserData& user, const NiteUserTrackerFrame& frame, const Tracker& tracker) {
  const NiteBoundingBox& box = user.boundingBox;
  float x = 0.F, y = 0.F;
  ASSERT_EQ(niteConvertJointCoordinatesToDepth(tracker.get(), user.centerOfMass.x, user.centerOfMass.y,
                                               user.centerOfMass.z, &x, &y),
            NITE_STATUS_OK);
  EXPECT_TRUE(x > box.min.x && x < box.max.x && y > box.min.y && y < box.max.y) << x << " " << y;
  EXPECT_TRUE(user.centerOfMass.z > box.min.z && user.centerOfMass.z < box.max.z);
  for (int v = 0; v < frame.userMap.height; ++v) {
    for (int u = 0; u < frame.userMap.width; ++u) {
      if (frame.userMap.pixels[v * frame.userMap.width + u] != user.id) continue;
      const auto* row = reinterpret_cast<const std::uint16_t*>(static_cast<const char*>(frame.pDepthFrame->data) +
                                                               v * frame.pDepthFrame->stride);
      ASSERT_TRUE(row[u] == 0 || (float(u) >= box.min.x && float(u) <= box.max.x && float(v) >= box.min.y &&
                                  float(v) <= box.max.y && float(row[u]) >= box.min.z && float(row[u]) <= box.max.z))
          << u << " " << v;
    }
  }
}

// Labels: slow
TEST(Nite2, GivesThePeopleOfTheTrackerToTheBitMirroredOrNot) {
  const Nite nite(kModel);
  const Detector detector(load_model(kModel));
  for (const bool is_mirrored : {false, true}) {
    Device device(view_of(test::rooms()[0].camera, is_mirrored));
    const Tracker theirs = tracker_on(device);
    PeopleTracker tracker = make_tracker(detector, {});
    std::uint64_t usec = 5'000'000;
    int placed = 0, people = 0;
    std::set<int> known;
    for (const std::size_t which : {0, 0, 0, 0, 1, 2, 3, 4, 5, 5, 5}) {
      Frame frame = depth_frame(test::rooms().at(which).depth, camera_of(device.view()));
      frame.time_s = seconds(usec);
      const TrackedFrame expected = follow(detector, tracker, frame);
      device.push(is_mirrored ? mirrored(frame.depth) : frame.depth, usec);
      const Users users = read(theirs);
      EXPECT_EQ(users->timestamp, usec);
      EXPECT_EQ(users->pDepthFrame->timestamp, usec);
      EXPECT_EQ(users->frameIndex, users->pDepthFrame->frameIndex);
      expect_map(expected, users->userMap, device.view());
      ASSERT_GE(users->userCount, int(expected.people.size()));
      for (std::size_t i = 0; i < expected.people.size(); ++i) {
        const TrackedPerson& person = expected.people[i];
        const NiteUserData& user = users->pUser[i];
        EXPECT_EQ(user.id, person.id);
        const bool is_new = known.insert(person.id).second;
        EXPECT_EQ(user.state, person.state == TrackState::lost ? 4 : (is_found(person) ? 1 : 0) + (is_new ? 2 : 0));
        if (is_new) {
          EXPECT_EQ(user.skeleton.state, NITE_SKELETON_NONE);
          EXPECT_FALSE(niteIsSkeletonTracking(theirs.get(), user.id));
          EXPECT_EQ(niteStartSkeletonTracking(theirs.get(), user.id), NITE_STATUS_OK);
          EXPECT_TRUE(niteIsSkeletonTracking(theirs.get(), user.id));
        } else {
          placed += expect_skeleton(person, detector.body(), user, is_mirrored);
          ++people;
        }
        if (is_found(person)) expect_place(user, *users, theirs);
      }
      for (int i = int(expected.people.size()); i < users->userCount; ++i) {
        EXPECT_EQ(users->pUser[i].state, NITE_USER_STATE_LOST);
        EXPECT_EQ(known.erase(users->pUser[i].id), 1U);
      }
      for (const TrackedPerson& person : expected.people) {
        if (person.state == TrackState::lost) known.erase(person.id);
      }
      usec += 5 * kStep_usec;
    }
    EXPECT_GE(people, 4);
    EXPECT_GE(placed, 14 * people);
  }
}

/// An empty room: the camera looks at the wall from 1.2 metres above the floor.
TEST(Nite2, SaysWhereTheFloorIs) {
  const Nite nite;
  for (const int is_mirrored : {0, 1}) {
    Device device({320, 240, 1.F, 0.8F, is_mirrored, 1});
    const Tracker tracker = tracker_on(device);
    const float focal = 120.F / std::tan(0.4F);
    DepthImage room(320, 240, 4000);
    for (int v = 0; v < 240; ++v) {
      for (int u = 0; u < 320; ++u) {
        const float floor_mm = 1200.F * focal / (float(v) - 120.F);
        if (v > 120 && floor_mm < 4000.F) room(u, v) = static_cast<std::uint16_t>(std::lround(floor_mm));
      }
    }
    device.push(room, 1);
    EXPECT_EQ(read(tracker)->floorConfidence, 0.F) << "not at once";
    for (std::uint64_t i = 1; i <= 20; ++i) {
      device.push(room, i * kStep_usec);
      const Users users = read(tracker);
      if (i < 20) continue;
      ASSERT_EQ(users->floorConfidence, 1.F);
      const NitePlane& floor = users->floor;
      EXPECT_NEAR(floor.normal.y, 1.F, 0.01F);
      EXPECT_NEAR(floor.normal.x, 0.F, 0.03F);
      EXPECT_NEAR(floor.point.y, -1200.F, 20.F);
      EXPECT_NEAR(floor.point.z, 0.F, 100.F);
    }
  }
}

/// Left is the person's own left, on both sides of the mirror.
// Labels: slow
TEST(Nite2, LeftIsThePersonsOwnLeftInMirroredPicturesToo) {
  const Nite nite(kModel);
  std::array<std::array<NiteSkeletonJoint, 2>, 2> shoulders{};
  for (const bool is_mirrored : {false, true}) {
    Device device(view_of(test::rooms()[0].camera, is_mirrored));
    const Tracker tracker = tracker_on(device);
    const DepthImage& depth = test::rooms()[0].depth;
    for (std::uint64_t i = 1; i <= 2; ++i) {
      device.push(is_mirrored ? mirrored(depth) : depth, i * kStep_usec);
      const Users users = read(tracker);
      ASSERT_GE(users->userCount, 1);
      niteStartSkeletonTracking(tracker.get(), users->pUser[0].id);
      const NiteSkeletonJoint* joints = users->pUser[0].skeleton.joints;
      shoulders[is_mirrored ? 1 : 0] = {joints[NITE_JOINT_LEFT_SHOULDER], joints[NITE_JOINT_RIGHT_SHOULDER]};
    }
  }
  for (int side = 0; side < 2; ++side) {
    const auto &plain = shoulders[0][side], &mirror = shoulders[1][side];
    EXPECT_GT(plain.positionConfidence, 0.F);
    EXPECT_NEAR(plain.position.x, -mirror.position.x, 12.F) << "half a pixel at some metres";
    EXPECT_NEAR(plain.position.z, mirror.position.z, 12.F);
    const NiteQuaternion &p = plain.orientation, &m = mirror.orientation;
    EXPECT_NEAR(p.w * m.w + p.x * m.x - p.y * m.y - p.z * m.z, 1.F, 0.01F) << "turned the other way";
  }
}

/// Pictures of a part of the view, in tenths of millimetres, of half the size.
// Labels: slow
TEST(Nite2, TakesTenthsOfMillimetresAndCroppedPicturesAndSmallOnes) {
  const Nite nite(kModel);
  const Frame& room = test::rooms()[0];
  Device device(view_of(room.camera, false));
  const auto chest_of = [&](const DepthImage& depth, const FakeView& view, OniPixelFormat format,
                            std::optional<std::pair<int, int>> crop) {
    device.see(view);
    const Tracker tracker = tracker_on(device);
    NiteSkeletonJoint chest{};
    for (std::uint64_t i = 1; i <= 2; ++i) {
      device.push(depth, i * kStep_usec, format, crop);
      const Users users = read(tracker);
      EXPECT_EQ(users->userMap.width, depth.width());
      EXPECT_GE(users->userCount, 1);
      if (users->userCount == 0) break;
      niteStartSkeletonTracking(tracker.get(), users->pUser[0].id);
      chest = users->pUser[0].skeleton.joints[NITE_JOINT_TORSO];
    }
    return chest;
  };
  const NiteSkeletonJoint whole = chest_of(room.depth, device.view(), ONI_PIXEL_FORMAT_DEPTH_1_MM, {});
  ASSERT_GT(whole.positionConfidence, 0.F);
  const auto expect_there = [&](const NiteSkeletonJoint& chest, float most_mm) {
    EXPECT_GT(chest.positionConfidence, 0.F);
    EXPECT_NEAR(chest.position.x, whole.position.x, most_mm);
    EXPECT_NEAR(chest.position.y, whole.position.y, most_mm);
    EXPECT_NEAR(chest.position.z, whole.position.z, most_mm);
  };

  const FakeView view = device.view();
  DepthImage tenths = room.depth;
  for (std::uint16_t& z : tenths) z = z > 6500 ? 0 : static_cast<std::uint16_t>(10 * z);
  expect_there(chest_of(tenths, view, ONI_PIXEL_FORMAT_DEPTH_100_UM, {}), 30.F);

  DepthImage part(view.width - 32, view.height - 16);
  for (int v = 0; v < part.height(); ++v) std::copy_n(room.depth.row(v + 8) + 24, part.width(), part.row(v));
  expect_there(chest_of(part, view, ONI_PIXEL_FORMAT_DEPTH_1_MM, std::pair(24, 8)), 40.F);
  for (const bool is_mirrored : {true}) {
    FakeView mirror = view;
    mirror.mirrored = is_mirrored ? 1 : 0;
    // 8 columns are left out at the right of the picture, which is mirrored: they are at its left then.
    NiteSkeletonJoint chest = chest_of(mirrored(part), mirror, ONI_PIXEL_FORMAT_DEPTH_1_MM, std::pair(8, 8));
    chest.position.x = -chest.position.x;
    expect_there(chest, 40.F);
  }

  DepthImage half(view.width / 2, view.height / 2);
  for (int v = 0; v < half.height(); ++v) {
    for (int u = 0; u < half.width(); ++u) half(u, v) = room.depth(2 * u, 2 * v);
  }
  FakeView small = view;
  small.width /= 2;
  small.height /= 2;
  expect_there(chest_of(half, small, ONI_PIXEL_FORMAT_DEPTH_1_MM, {}), 120.F);
}

// Labels: slow
TEST(Nite2, TellsWhoIsNewVisibleAndLost) {
  const Nite nite(kModel);
  Device device(view_of(test::rooms()[0].camera, false));
  const Tracker tracker = tracker_on(device);
  std::uint64_t usec = 1'000'000;
  const auto next = [&](const DepthImage& depth) {
    device.push(depth, usec);
    usec += 200'000;
    return read(tracker);
  };
  const DepthImage &room = test::rooms()[0].depth, nobody(room.width(), room.height(), 4000);
  Users users = next(room);
  ASSERT_GE(users->userCount, 1);
  const NiteUserId id = users->pUser[0].id;
  EXPECT_EQ(users->pUser[0].state, NITE_USER_STATE_VISIBLE | NITE_USER_STATE_NEW);
  EXPECT_EQ(niteStartSkeletonTracking(tracker.get(), id), NITE_STATUS_OK);
  for (int i = 0; i < 5; ++i) users = next(room);
  EXPECT_EQ(users->pUser[0].state, NITE_USER_STATE_VISIBLE);
  EXPECT_EQ(users->pUser[0].skeleton.state, NITE_SKELETON_TRACKED);
  NitePoseType no_pose{};
  const int number = 5;
  std::memcpy(&no_pose, &number, sizeof number);
  EXPECT_EQ(niteStartPoseDetection(tracker.get(), id, no_pose), NITE_STATUS_ERROR);
  EXPECT_EQ(niteStartPoseDetection(tracker.get(), id, NITE_POSE_CROSSED_HANDS), NITE_STATUS_OK);
  users = next(room);
  EXPECT_EQ(users->pUser[0].poses[0].type, NITE_POSE_PSI);
  EXPECT_EQ(users->pUser[0].poses[0].state, 0);
  EXPECT_EQ(users->pUser[0].poses[1].type, NITE_POSE_CROSSED_HANDS);
  EXPECT_EQ(users->pUser[0].poses[1].state, NITE_POSE_STATE_DETECTING) << "arms hang";
  niteStopAllPoseDetection(tracker.get(), id);
  niteStopSkeletonTracking(tracker.get(), id);
  users = next(room);
  EXPECT_EQ(users->pUser[0].poses[1].state, 0);
  EXPECT_EQ(users->pUser[0].skeleton.state, NITE_SKELETON_NONE);
  EXPECT_EQ(users->pUser[0].skeleton.joints[NITE_JOINT_HEAD].positionConfidence, 0.F);

  const auto state_of = [&]() -> std::optional<int> {
    for (int i = 0; i < users->userCount; ++i) {
      if (users->pUser[i].id == id) return users->pUser[i].state;
    }
    return std::nullopt;
  };
  std::vector<std::optional<int>> states;
  for (int i = 0; i < 100 && (states.empty() || states.back()); ++i) {
    users = next(nobody);
    states.push_back(state_of());
  }
  ASSERT_GE(states.size(), 3U);
  EXPECT_EQ(states.front(), 0) << "hidden at first";
  EXPECT_EQ(states[states.size() - 2], NITE_USER_STATE_LOST) << "once";
  EXPECT_EQ(std::ranges::count(states, std::optional<int>(NITE_USER_STATE_LOST)), 1);
  EXPECT_EQ(states.back(), std::nullopt);
  EXPECT_EQ(niteStartSkeletonTracking(tracker.get(), id), NITE_STATUS_BAD_USER_ID);
}

// Labels: slow
TEST(Nite2, SmoothsJointsByTheFactor) {
  const Nite nite(kModel);
  test::expect_smoothing([&](float factor) {
    Device device(view_of(test::rooms()[0].camera, false));
    const Tracker tracker = tracker_on(device);
    EXPECT_EQ(niteSetSkeletonSmoothing(tracker.get(), factor), NITE_STATUS_OK);
    float moved = 0.F, told = -1.F;
    EXPECT_EQ(niteGetSkeletonSmoothing(tracker.get(), &told), NITE_STATUS_OK);
    EXPECT_EQ(told, factor);
    std::optional<float> last;
    for (std::uint64_t i = 1; i <= 6; ++i) {
      device.push(test::shaken(test::rooms()[0].depth, i), i * kStep_usec);
      const Users users = read(tracker);
      niteStartSkeletonTracking(tracker.get(), users->pUser[0].id);
      if (i == 1) continue;
      const float at = users->pUser[0].skeleton.joints[NITE_JOINT_TORSO].position.z;
      if (last) moved += std::abs(at - *last);
      last = at;
    }
    return moved;
  });
}

TEST(Nite2, ConvertsAsOpenniDoes) {
  const Nite nite;
  Device device(kQuickView);
  const Tracker tracker = tracker_on(device);
  float x = 0.F, y = 0.F, back_x = 0.F, back_y = 0.F;
  // x / (2 z tan(field / 2)) + 1/2 of the width; up is towards row 0.
  ASSERT_EQ(niteConvertJointCoordinatesToDepth(tracker.get(), 500.F, 250.F, 2000.F, &x, &y), NITE_STATUS_OK);
  EXPECT_NEAR(x, 160.F * (500.F / (2.F * 2000.F * std::tan(0.5F)) + 0.5F), 1e-3F);
  EXPECT_NEAR(y, 120.F * (0.5F - 250.F / (2.F * 2000.F * std::tan(0.4F))), 1e-3F);
  ASSERT_EQ(niteConvertDepthCoordinatesToJoint(tracker.get(), 100, 20, 2000, &back_x, &back_y), NITE_STATUS_OK);
  ASSERT_EQ(niteConvertJointCoordinatesToDepth(tracker.get(), back_x, back_y, 2000.F, &x, &y), NITE_STATUS_OK);
  EXPECT_NEAR(x, 100.F, 1e-3F);
  EXPECT_NEAR(y, 20.F, 1e-3F);
  EXPECT_EQ(niteConvertJointCoordinatesToDepth(tracker.get(), 1.F, 1.F, 0.F, &x, &y), NITE_STATUS_ERROR);
  EXPECT_EQ(x, 0.F);
  EXPECT_EQ(niteConvertJointCoordinatesToDepth(tracker.get(), 1.F, 1.F, 1.F, nullptr, &y), NITE_STATUS_ERROR);
  EXPECT_EQ(niteConvertDepthCoordinatesToJoint(nullptr, 1, 1, 1, &x, &y), NITE_STATUS_ERROR);
}

TEST(Nite2, CountsReferencesAndFramesOutliveTheirTracker) {
  const int before = fake_held();
  {
    const Nite nite;
    Device device(kQuickView);
    Tracker tracker = tracker_on(device);
    device.push(quick_wall(), 77);
    Users users = read(tracker);
    EXPECT_EQ(fake_held(), before + 3) << "the device, its stream, and the picture";
    EXPECT_EQ(niteUserTrackerFrameAddRef(tracker.get(), users.get()), NITE_STATUS_OK);
    EXPECT_EQ(niteUserTrackerFrameRelease(tracker.get(), users.get()), NITE_STATUS_OK);
    tracker.reset();
    EXPECT_EQ(fake_held(), before + 2);
    EXPECT_EQ(users->timestamp, 77U);
    EXPECT_EQ(users->userMap.pixels[160 * 120 - 1], 0);
    EXPECT_EQ(users->pDepthFrame->width, 160);
    NiteUserTrackerFrame* gone = users.get();
    users.reset();
    EXPECT_EQ(fake_held(), before + 1);
    EXPECT_EQ(niteUserTrackerFrameRelease(nullptr, gone), NITE_STATUS_ERROR) << "released twice";
    EXPECT_EQ(niteUserTrackerFrameAddRef(nullptr, gone), NITE_STATUS_ERROR);
  }
  EXPECT_EQ(fake_held(), before);
}

// Labels: threads
TEST(Nite2, OfACameraTheNewestIsReadAndOfARecordingAll) {
  const Nite nite;
  for (const bool is_recording : {false, true}) {
    FakeView view = kQuickView;
    view.is_recording = is_recording ? 1 : 0;
    Device device(view);
    const Tracker tracker = tracker_on(device);
    for (std::uint64_t i = 1; i <= 9; ++i) {
      device.push(quick_wall(), i);
      std::this_thread::sleep_for(std::chrono::milliseconds(is_recording ? 0 : 40));
    }
    std::vector<std::uint64_t> times;
    do times.push_back(read(tracker)->timestamp);
    while (times.back() < 9);
    EXPECT_EQ(times.size() == 9, is_recording) << times.size();
    EXPECT_TRUE(std::ranges::is_sorted(times));
  }
}

/// A program that is slower than the camera hears of everybody who is new all the same, and its wishes are of the next
/// frame that it reads.
// Labels: slow
TEST(Nite2, WhoLeavesFramesOutMissesNobody) {
  const Nite nite(kModel);
  FakeView view = view_of(test::rooms()[0].camera, false);
  view.is_recording = 0;
  Device device(view);
  const Tracker tracker = tracker_on(device);
  std::uint64_t usec = 0;
  const auto film = [&] {
    for (int i = 0; i < 3; ++i) {
      device.push(test::rooms()[0].depth, usec += kStep_usec);
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
    }
  };
  film();
  Users users = read(tracker);
  ASSERT_GE(users->userCount, 1);
  const NiteUserId id = users->pUser[0].id;
  EXPECT_EQ(users->pUser[0].state, NITE_USER_STATE_VISIBLE | NITE_USER_STATE_NEW);
  film();
  EXPECT_EQ(niteStartSkeletonTracking(tracker.get(), id), NITE_STATUS_OK);
  users = read(tracker);
  EXPECT_EQ(users->pUser[0].state, NITE_USER_STATE_VISIBLE);
  EXPECT_EQ(users->pUser[0].skeleton.state, NITE_SKELETON_TRACKED) << "though the frame was found before";
}

/// What a program's listener knows.
struct Listener {
  NiteUserTrackerCallbacks callbacks{};
  NiteUserTrackerHandle tracker = nullptr;
  std::atomic<int> called = 0;
  std::promise<void> second;

  static void read_it(void* cookie) {
    auto& self = *static_cast<Listener*>(cookie);
    NiteUserTrackerFrame* frame = nullptr;
    EXPECT_EQ(niteReadUserTrackerFrame(self.tracker, &frame), NITE_STATUS_OK);
    EXPECT_EQ(niteUserTrackerFrameRelease(self.tracker, frame), NITE_STATUS_OK);
    if (++self.called == 2) self.second.set_value();
  }
  static void shut_down(void* cookie) {
    auto& self = *static_cast<Listener*>(cookie);
    EXPECT_EQ(niteShutdownUserTracker(self.tracker), NITE_STATUS_OK);
    self.second.set_value();
  }
};

// Labels: threads
TEST(Nite2, CallsWhoListensAndNobodyElse) {
  const Nite nite;
  Device device(kQuickView);
  const Tracker tracker = tracker_on(device);
  device.push(quick_wall(), 1);
  device.push(quick_wall(), 2);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // what waits before somebody listens is told, too
  Listener listener, gone;
  listener.tracker = gone.tracker = tracker.get();
  listener.callbacks.readyForNextFrame = gone.callbacks.readyForNextFrame = &Listener::read_it;
  EXPECT_EQ(niteRegisterUserTrackerCallbacks(tracker.get(), &listener.callbacks, &listener), NITE_STATUS_OK);
  ASSERT_EQ(listener.second.get_future().wait_for(std::chrono::seconds(20)), std::future_status::ready);
  niteUnregisterUserTrackerCallbacks(tracker.get(), &listener.callbacks);
  niteUnregisterUserTrackerCallbacks(tracker.get(), &gone.callbacks);  // which never listened
  device.push(quick_wall(), 3);
  EXPECT_EQ(read(tracker)->timestamp, 3U);
  EXPECT_EQ(listener.called, 2);
  EXPECT_EQ(niteRegisterUserTrackerCallbacks(tracker.get(), nullptr, nullptr), NITE_STATUS_ERROR);
}

// Labels: threads
TEST(Nite2, MayBeShutDownInACallback) {
  const Nite nite;
  Device device(kQuickView);
  Tracker tracker = tracker_on(device);
  Listener listener;
  listener.tracker = tracker.release();
  listener.callbacks.readyForNextFrame = &Listener::shut_down;
  niteRegisterUserTrackerCallbacks(listener.tracker, &listener.callbacks, &listener);
  device.push(quick_wall(), 1);
  ASSERT_EQ(listener.second.get_future().wait_for(std::chrono::seconds(20)), std::future_status::ready);
  EXPECT_EQ(niteShutdownUserTracker(listener.tracker), NITE_STATUS_ERROR) << "it is gone";
  for (int i = 0; i < 200 && fake_held() > 1; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(fake_held(), 1) << "only the device";
}

// Labels: threads
TEST(Nite2, WhoWaitsHearsOfTheEnd) {
  const Nite nite;
  for (const int how : {0, 1, 2}) {
    Device device(kQuickView);
    Tracker tracker = tracker_on(device);
    auto waiting = std::async(std::launch::async, [handle = tracker.get()] {
      NiteUserTrackerFrame* frame = nullptr;
      return std::pair(niteReadUserTrackerFrame(handle, &frame), frame);
    });
    EXPECT_EQ(waiting.wait_for(std::chrono::milliseconds(30)), std::future_status::timeout);
    testing::internal::CaptureStderr();
    if (how == 0) tracker.reset();
    if (how == 1) fake_fail(device.handle());
    if (how == 2) niteShutdown();
    const auto [status, frame] = waiting.get();
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(status, NITE_STATUS_ERROR);
    ASSERT_NE(frame, nullptr) << "NiTE.h looks at it";
    EXPECT_EQ(frame->userCount, 0);
    EXPECT_EQ(frame->pDepthFrame, nullptr);
    EXPECT_EQ(niteUserTrackerFrameAddRef(nullptr, frame), NITE_STATUS_OK);
    EXPECT_EQ(niteUserTrackerFrameRelease(nullptr, frame), NITE_STATUS_OK);
    if (how == 1) {
      EXPECT_THAT(said, HasSubstr("depth does not come: the fake fails"));
    }
    if (how == 2) {
      (void)tracker.release();
      EXPECT_EQ(niteInitialize(), NITE_STATUS_OK);
    }
  }
}

TEST(Nite2, TellsWhatIsNoTracker) {
  const Nite nite;
  Device device(kQuickView);
  Tracker tracker = tracker_on(device);
  const NiteUserTrackerHandle gone = tracker.get();
  tracker.reset();
  std::size_t something = 0;
  NiteUserTrackerCallbacks callbacks{};
  for (const NiteUserTrackerHandle wrong :
       {gone, NiteUserTrackerHandle{}, reinterpret_cast<NiteUserTrackerHandle>(&something)}) {
    testing::internal::CaptureStderr();
    NiteUserTrackerFrame* frame = nullptr;
    float factor = 0.F;
    EXPECT_EQ(niteReadUserTrackerFrame(wrong, &frame), NITE_STATUS_ERROR);
    EXPECT_EQ(niteStartSkeletonTracking(wrong, 1), NITE_STATUS_ERROR);
    niteStopSkeletonTracking(wrong, 1);
    EXPECT_FALSE(niteIsSkeletonTracking(wrong, 1));
    EXPECT_EQ(niteSetSkeletonSmoothing(wrong, 0.5F), NITE_STATUS_ERROR);
    EXPECT_EQ(niteGetSkeletonSmoothing(wrong, &factor), NITE_STATUS_ERROR);
    EXPECT_EQ(niteStartPoseDetection(wrong, 1, NITE_POSE_PSI), NITE_STATUS_ERROR);
    niteStopPoseDetection(wrong, 1, NITE_POSE_PSI);
    niteStopAllPoseDetection(wrong, 1);
    EXPECT_EQ(niteRegisterUserTrackerCallbacks(wrong, &callbacks, nullptr), NITE_STATUS_ERROR);
    niteUnregisterUserTrackerCallbacks(wrong, &callbacks);
    EXPECT_EQ(niteShutdownUserTracker(wrong), NITE_STATUS_ERROR);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::ranges::count(said, '\n'), 12) << said;
    EXPECT_THAT(said, HasSubstr("libNiTE2 of vesalius: niteShutdownUserTracker: "));
  }
}

TEST(Nite2, TellsWhatIsNoFrameUserFactorOrPose) {
  const Nite nite;
  Device device(kQuickView);
  const Tracker tracker = tracker_on(device);
  NiteUserTrackerFrame own{};
  for (NiteUserTrackerFrame* wrong : {static_cast<NiteUserTrackerFrame*>(nullptr), &own}) {
    EXPECT_EQ(niteUserTrackerFrameAddRef(tracker.get(), wrong), NITE_STATUS_ERROR);
    EXPECT_EQ(niteUserTrackerFrameRelease(tracker.get(), wrong), NITE_STATUS_ERROR);
  }
  EXPECT_EQ(niteReadUserTrackerFrame(tracker.get(), nullptr), NITE_STATUS_ERROR);
  EXPECT_EQ(niteStartSkeletonTracking(tracker.get(), 1), NITE_STATUS_BAD_USER_ID) << "nobody is in view";
  EXPECT_EQ(niteStartPoseDetection(tracker.get(), 1, NITE_POSE_PSI), NITE_STATUS_BAD_USER_ID);
  for (const float factor : {-0.1F, 1.1F, NAN}) {
    EXPECT_EQ(niteSetSkeletonSmoothing(tracker.get(), factor), NITE_STATUS_ERROR);
  }
  EXPECT_EQ(niteGetSkeletonSmoothing(tracker.get(), nullptr), NITE_STATUS_ERROR);
}

TEST(Nite2, TellsWhatNoTrackerIsMadeOf) {
  std::size_t something = 0;
  NiteUserTrackerHandle made = nullptr;
  Device device(kQuickView);
  EXPECT_EQ(niteInitializeUserTracker(&made), NITE_STATUS_OUT_OF_FLOW);
  EXPECT_EQ(niteInitializeUserTrackerByDevice(device.object(), &made), NITE_STATUS_OUT_OF_FLOW);
  const Nite nite;
  const auto said_of = [&](void* of) {
    made = reinterpret_cast<NiteUserTrackerHandle>(&something);
    testing::internal::CaptureStderr();
    EXPECT_EQ(niteInitializeUserTrackerByDevice(of, &made), NITE_STATUS_ERROR);
    EXPECT_EQ(made, nullptr);
    std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
    return said;
  };
  EXPECT_EQ(niteInitializeUserTracker(nullptr), NITE_STATUS_ERROR);
  EXPECT_EQ(niteInitializeUserTrackerByDevice(device.object(), nullptr), NITE_STATUS_ERROR);
  EXPECT_THAT(said_of(nullptr), HasSubstr("the device is NULL"));
  std::array<void*, 2> closed{};
  EXPECT_THAT(said_of(closed.data()), HasSubstr("the device's handle is NULL"));
  FakeView no_size = kQuickView;
  no_size.width = 0;
  Device blind(no_size);
  EXPECT_THAT(said_of(blind.object()), HasSubstr("no size of depth"));
  setenv("VESALIUS_MODEL", "/nowhere/my.model", 1);
  EXPECT_THAT(said_of(device.object()), HasSubstr("/nowhere/my.model"));
  setenv("VESALIUS_MODEL", kQuickModel.c_str(), 1);
  fake_fail(device.handle());
  EXPECT_THAT(said_of(device.object()), HasSubstr("the device has no depth: the fake fails"));
}

TEST(Nite2, SaysOfHandsThatTheyAreNotFollowed) {
  const Nite nite;
  std::size_t something = 0;
  auto hands = reinterpret_cast<NiteHandTrackerHandle>(&something);
  NiteHandTrackerFrame* frame = nullptr;
  NiteHandId id = 7;
  const NitePoint3f point{};
  EXPECT_EQ(niteReadHandTrackerFrame(hands, &frame), NITE_STATUS_ERROR);
  ASSERT_NE(frame, nullptr) << "NiTE.h looks at it";
  EXPECT_EQ(frame->handCount + frame->gestureCount, 0);
  EXPECT_EQ(niteHandTrackerFrameRelease(hands, frame), NITE_STATUS_ERROR);
  EXPECT_EQ(niteStartHandTracking(hands, &point, &id), NITE_STATUS_ERROR);
  EXPECT_EQ(id, 0);
  EXPECT_EQ(niteStartGestureDetection(hands, NITE_GESTURE_WAVE), NITE_STATUS_ERROR);
  EXPECT_EQ(niteInitializeHandTracker(&hands), NITE_STATUS_ERROR);
  EXPECT_EQ(hands, nullptr);
}

TEST(Nite2, PicturesOfOtherKindsHaveNobody) {
  const Nite nite;
  Device device(kQuickView);
  const Tracker tracker = tracker_on(device);
  testing::internal::CaptureStderr();
  device.push(quick_wall(), 1, static_cast<OniPixelFormat>(102));
  device.push(quick_wall(), 2);
  EXPECT_EQ(read(tracker)->timestamp, 1U);
  EXPECT_EQ(read(tracker)->timestamp, 2U) << "the next is as any";
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("depth of format 102, expected millimetres"));
}

/// Programs change the mode of the stream while a tracker runs.
TEST(Nite2, FollowsAChangeOfMode) {
  const Nite nite;
  Device device(kQuickView);
  const Tracker tracker = tracker_on(device);
  device.push(quick_wall(), 1);
  EXPECT_EQ(read(tracker)->userMap.width, 160);
  FakeView larger = kQuickView;
  larger.width = 320;
  larger.height = 240;
  larger.mirrored = 1;
  device.see(larger);
  device.push(DepthImage(320, 240, 3000), 2);
  EXPECT_EQ(read(tracker)->userMap.width, 320);
  device.push(DepthImage(320, 240, 3000), 3);
  EXPECT_EQ(read(tracker)->userMap.stride, 640);
}

// Labels: threads
TEST(Nite2, EightThreadsHaveTheirOwnTrackersAndShareFrames) {
  const int before = fake_held();
  {
    const Nite nite;
    Device device(kQuickView);
    const Tracker shared = tracker_on(device);
    device.push(quick_wall(), 42);
    const Users seen_by_all = read(shared);
    std::atomic<int> right = 0;
    std::vector<std::thread> threads;
    for (std::uint64_t t = 1; t <= 8; ++t) {
      threads.emplace_back([&, t] {
        Device mine(kQuickView);
        const Tracker own = tracker_on(mine);
        for (std::uint64_t i = 0; i < 5; ++i) {
          mine.push(quick_wall(), t * 1000 + i);
          const Users users = read(own);
          niteUserTrackerFrameAddRef(shared.get(), seen_by_all.get());
          right += users->timestamp == t * 1000 + i && seen_by_all->timestamp == 42 ? 1 : 0;
          niteUserTrackerFrameRelease(shared.get(), seen_by_all.get());
          niteSetSkeletonSmoothing(shared.get(), 0.3F);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(right, 40);
  }
  EXPECT_EQ(fake_held(), before);
}

std::size_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * 4096;
}

// Labels: slow
TEST(Nite2, AThousandFramesNeedNoMoreMemory) {
  const Nite nite;
  FakeView view = kQuickView;
  view.width = 80;
  view.height = 60;
  Device device(view);
  const Tracker tracker = tracker_on(device);
  const int held = fake_held();
  std::size_t before = 0;
  for (std::uint64_t i = 1; i <= 1200; ++i) {
    device.push(DepthImage(80, 60, 3000), i * kStep_usec);
    EXPECT_EQ(read(tracker)->timestamp, i * kStep_usec);
    if (i == 200) before = resident_bytes();
  }
  EXPECT_EQ(fake_held(), held);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr std::size_t kMost = 500U << 20U;  // theirs is kept
#else
  constexpr std::size_t kMost = 8U << 20U;  // a thousand frames are 19 MiB with their maps
#endif
  EXPECT_LT(resident_bytes(), before + kMost);
}

/// Programs in C and C++ that were written for the interface say of a recording what the C++ tracker does.
// Labels: slow
TEST(Nite2, ProgramsOfTheInterfaceRun) {
  const test::TemporaryFolder folder;
  const Detector detector(load_model(kModel));
  PeopleTracker tracker = make_tracker(detector, {});
  const std::size_t set = find_joint_set(detector.body(), "nite15");
  const FakeView view = view_of(test::rooms()[0].camera, false);
  std::ofstream file(folder / "recording", std::ios::binary);
  file.write(reinterpret_cast<const char*>(&view), sizeof view);
  std::string expected;
  std::map<int, int> seen;
  std::uint64_t usec = 1'000'000;
  int frames = 0;
  for (const std::size_t which : {0, 0, 1, 1, 2, 2}) {
    Frame frame = depth_frame(test::rooms()[which].depth, camera_of(view));
    frame.time_s = seconds(usec);
    file.write(reinterpret_cast<const char*>(&usec), sizeof usec);
    file.write(reinterpret_cast<const char*>(frame.depth.data()), std::streamsize(frame.depth.size() * 2));
    const TrackedFrame people = follow(detector, tracker, frame);
    const auto map = body_index_map(people_of(people), view.width, view.height);
    expected += "frame " + std::to_string(usec) + "\n";
    for (std::size_t i = 0; i < people.people.size(); ++i) {
      const TrackedPerson& person = people.people[i];
      const bool is_new = seen[person.id]++ == 0;
      const Joint head = is_new ? Joint{} : person.person.joints[set][0];
      std::array<char, 128> line{};
      std::snprintf(line.data(), line.size(), "%d %d: %d %.3f %.3f %.3f %.3f, %ld\n", person.id,
                    (is_found(person) ? 1 : 0) + (is_new ? 2 : 0), is_new ? 0 : 2, double(1000.F * head.position.x()),
                    is_new ? 0.0 : double(-1000.F * head.position.y()), double(1000.F * head.position.z()),
                    double(head.confidence), long(std::ranges::count(map, static_cast<std::uint8_t>(i))));
      expected += line.data();
    }
    for (auto& [id, count] : seen) {
      const bool is_there = std::ranges::find(people.people, id, &TrackedPerson::id) != people.people.end();
      if (is_there || std::exchange(count, -1) < 0) continue;
      expected += std::to_string(id) + " 4: 0 0.000 0.000 0.000 0.000, 0\n";  // of whom the tracker says nothing more
    }
    usec += kStep_usec;
    ++frames;
  }
  file.close();
  EXPECT_THAT(expected, HasSubstr("\n1 1: 2 "));
  const std::string environment = "VESALIUS_MODEL='" + kModel + "' FAKE_OPENNI2='" + (folder / "recording") + "' ";
  for (const std::string program : {VESALIUS_USER_LOOP, VESALIUS_LISTENER}) {
    EXPECT_EQ(test::output_of(environment + program + " " + std::to_string(frames)), expected) << program;
  }
}

}  // namespace
}  // namespace vesalius
