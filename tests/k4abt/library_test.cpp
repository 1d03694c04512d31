// libk4abt.so as programs call it, on a libk4a without a camera, beside the C++ tracker.

#include <gmock/gmock.h>
#include <k4a/k4a.h>
#include <k4abt.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "../standin/test_program.h"
#include "../standin/test_smoothing.h"
#include "io/files/test_files.h"
#include "io/lens/lens.h"
#include "io/sources/test_rooms.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"
#include "vesalius/track_people.h"
#include "vesalius/upright.h"

namespace vesalius {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

const std::string kData = std::string(VESALIUS_SOURCE_DIR) + "/data/";
const std::string kModel = kData + "models/default.model";
const std::string kQuickModel = kData + "models/capsule.forest";
constexpr std::uint64_t kStep_usec = 33'333;

template <class T, void (*release)(T)>
struct Release {
  void operator()(std::remove_pointer_t<T>* handle) const { release(handle); }
};
template <class T, void (*release)(T)>
using Owned = std::unique_ptr<std::remove_pointer_t<T>, Release<T, release>>;
using Tracker = Owned<k4abt_tracker_t, k4abt_tracker_destroy>;
using Bodies = Owned<k4abt_frame_t, k4abt_frame_release>;
using Capture = Owned<k4a_capture_t, k4a_capture_release>;
using Picture = Owned<k4a_image_t, k4a_image_release>;

k4a_calibration_t calibration_of(const Camera& camera) {
  k4a_calibration_t calibration{};
  calibration.depth_mode = K4A_DEPTH_MODE_NFOV_UNBINNED;
  k4a_calibration_camera_t& depth = calibration.depth_camera_calibration;
  depth.resolution_width = camera.width;
  depth.resolution_height = camera.height;
  depth.intrinsics.type = K4A_CALIBRATION_LENS_DISTORTION_MODEL_BROWN_CONRADY;
  depth.intrinsics.parameter_count = 14;
  depth.intrinsics.parameters.param.fx = camera.fx;
  depth.intrinsics.parameters.param.fy = camera.fy;
  depth.intrinsics.parameters.param.cx = camera.cx;
  depth.intrinsics.parameters.param.cy = camera.cy;
  return calibration;
}

template <class T>
Picture picture_of(const Image<T>& pixels, k4a_image_format_t format) {
  const int row = pixels.width() * int(sizeof(T)), stride = row + 6;  // rows need not follow each other
  k4a_image_t made = nullptr;
  EXPECT_EQ(k4a_image_create(format, pixels.width(), pixels.height(), stride, &made), K4A_RESULT_SUCCEEDED);
  for (int v = 0; v < pixels.height(); ++v) {
    std::memcpy(k4a_image_get_buffer(made) + v * stride, pixels.row(v), static_cast<std::size_t>(row));
  }
  return Picture(made);
}

using Bgra = std::array<std::uint8_t, 4>;

Capture capture_of(const Frame& frame, std::uint64_t usec) {
  k4a_capture_t made = nullptr;
  EXPECT_EQ(k4a_capture_create(&made), K4A_RESULT_SUCCEEDED);
  const Picture depth = picture_of(frame.depth, K4A_IMAGE_FORMAT_DEPTH16);
  k4a_image_set_device_timestamp_usec(depth.get(), usec);
  k4a_image_set_system_timestamp_nsec(depth.get(), 7 * usec);
  k4a_capture_set_depth_image(made, depth.get());
  if (!frame.colour.empty()) {
    Image<Bgra> colour(frame.colour.width(), frame.colour.height());
    for (std::size_t i = 0; i < colour.size(); ++i) {
      colour[i] = {frame.colour[i].b, frame.colour[i].g, frame.colour[i].r, 255};
    }
    k4a_capture_set_color_image(made, picture_of(colour, K4A_IMAGE_FORMAT_COLOR_BGRA32).get());
  }
  return Capture(made);
}

Tracker make_k4abt(const k4a_calibration_t& calibration, const std::string& model,
                   k4abt_sensor_orientation_t orientation = K4ABT_SENSOR_ORIENTATION_DEFAULT) {
  k4abt_tracker_configuration_t config = K4ABT_TRACKER_CONFIG_DEFAULT;
  config.model_path = model.c_str();
  config.sensor_orientation = orientation;
  k4abt_tracker_t made = nullptr;
  EXPECT_EQ(k4abt_tracker_create(&calibration, config, &made), K4A_RESULT_SUCCEEDED);
  return Tracker(made);
}

/// A small forest is enough where only calls matter; small pictures too.
const Frame& quick_frame() {
  static const Frame frame = depth_frame(DepthImage(160, 120, 3000), Camera{160, 120, 140.F, 140.F, 79.5F, 59.5F});
  return frame;
}
Tracker quick_tracker() { return make_k4abt(calibration_of(quick_frame().camera), kQuickModel); }

Bodies next_bodies(const Tracker& tracker, const Frame& frame, std::uint64_t usec) {
  EXPECT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), capture_of(frame, usec).get(), K4A_WAIT_INFINITE),
            K4A_WAIT_RESULT_SUCCEEDED);
  k4abt_frame_t bodies = nullptr;
  EXPECT_EQ(k4abt_tracker_pop_result(tracker.get(), &bodies, K4A_WAIT_INFINITE), K4A_WAIT_RESULT_SUCCEEDED);
  return Bodies(bodies);
}

std::vector<std::uint8_t> index_map(const Bodies& bodies) {
  const Picture map(k4abt_frame_get_body_index_map(bodies.get()));
  const std::uint8_t* pixels = k4a_image_get_buffer(map.get());
  EXPECT_EQ(k4a_image_get_format(map.get()), K4A_IMAGE_FORMAT_CUSTOM8);
  EXPECT_EQ(k4a_image_get_stride_bytes(map.get()), k4a_image_get_width_pixels(map.get()));
  return {pixels, pixels + k4a_image_get_size(map.get())};
}

k4abt_skeleton_t skeleton_at(const Bodies& bodies, std::uint32_t index) {
  k4abt_skeleton_t skeleton{};
  EXPECT_EQ(k4abt_frame_get_body_skeleton(bodies.get(), index, &skeleton), K4A_RESULT_SUCCEEDED);
  return skeleton;
}

std::vector<TrackedPerson> found_in(const TrackedFrame& frame) {
  std::vector<TrackedPerson> found;
  std::ranges::copy_if(frame.people, std::back_inserter(found), is_found);
  return found;
}

std::vector<Person> only_people(const std::vector<TrackedPerson>& tracked) {
  std::vector<Person> people;
  people.reserve(tracked.size());
  for (const TrackedPerson& one : tracked) people.push_back(one.person);
  return people;
}

void expect_joint(const Joint& expected, const std::optional<Eigen::Quaternionf>& rotation, const k4abt_joint_t& joint,
                  const k4abt_joint_t& parent) {
  if (expected.state == State::none) {
    EXPECT_EQ(joint.confidence_level, K4ABT_JOINT_CONFIDENCE_NONE);
    EXPECT_EQ(joint.position.xyz.z, parent.position.xyz.z);
  } else {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(joint.position.v[axis], 1000.F * expected.position[axis]);
    EXPECT_EQ(joint.confidence_level,
              expected.confidence < 0.5F ? K4ABT_JOINT_CONFIDENCE_LOW : K4ABT_JOINT_CONFIDENCE_MEDIUM);
  }
  const k4a_quaternion_t& q = joint.orientation;
  if (rotation) {
    EXPECT_EQ(q.wxyz.w, rotation->w());
    EXPECT_EQ(Eigen::Vector3f(q.v[1], q.v[2], q.v[3]), rotation->vec());
  } else {
    EXPECT_EQ(q.wxyz.w, parent.orientation.wxyz.w);
  }
}

/// Expects what the C++ interface says of the frame. Returns how many joints have a place.
int expect_same(const std::vector<TrackedPerson>& expected, const BodyModel& body, const Frame& frame,
                const Bodies& bodies) {
  EXPECT_EQ(k4abt_frame_get_num_bodies(bodies.get()), expected.size());
  EXPECT_THAT(index_map(bodies),
              ElementsAreArray(body_index_map(only_people(expected), frame.camera.width, frame.camera.height)));
  const JointSet& set = body.joint_sets[find_joint_set(body, "k4abt32")];
  int placed = 0;
  for (std::uint32_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(k4abt_frame_get_body_id(bodies.get(), i), static_cast<std::uint32_t>(expected[i].id));
    const k4abt_skeleton_t skeleton = skeleton_at(bodies, i);
    const auto rotations = rotations_of(expected[i], set);
    const auto& joints = expected[i].person.joints[find_joint_set(body, "k4abt32")];
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const bool is_thumb = j == K4ABT_JOINT_THUMB_LEFT || j == K4ABT_JOINT_THUMB_RIGHT;
      expect_joint(joints[j], rotations[j], skeleton.joints[j], skeleton.joints[is_thumb ? j - 3 : j]);
      placed += joints[j].state != State::none ? 1 : 0;
    }
  }
  return placed;
}

double seconds(std::uint64_t usec) { return double(usec * 1000) / 1e9; }

// Labels: slow
TEST(K4abt, GivesThePeopleOfTheTrackerToTheBit) {
  const Detector detector(load_model(kModel));
  PeopleTracker tracker = make_tracker(detector, {});
  const Tracker theirs = make_k4abt(calibration_of(test::rooms()[0].camera), kModel);
  std::uint64_t usec = 5'000'000;
  int placed = 0, people = 0;
  for (const std::size_t which : {0, 0, 0, 1, 2, 3, 4, 5}) {
    Frame frame = test::rooms().at(which);
    frame.time_s = seconds(usec);
    const std::vector<TrackedPerson> expected = found_in(follow(detector, tracker, frame));
    const Bodies bodies = next_bodies(theirs, frame, usec);
    placed += expect_same(expected, detector.body(), frame, bodies);
    people += int(expected.size());
    EXPECT_EQ(k4abt_frame_get_device_timestamp_usec(bodies.get()), usec);
    EXPECT_EQ(k4abt_frame_get_timestamp_usec(bodies.get()), usec);
    EXPECT_EQ(k4abt_frame_get_system_timestamp_nsec(bodies.get()), 7 * usec);
    usec += kStep_usec;
  }
  EXPECT_GE(people, 8);
  EXPECT_GE(placed, 28 * people);
}

/// Whatever the camera's mounting, people are found as in upright pictures, in the camera's own frame.
// Labels: slow
TEST(K4abt, TurnsPicturesOfCamerasThatAreMountedOtherwise) {
  const Detector detector(load_model(kModel));
  struct Mounting {
    k4abt_sensor_orientation_t orientation;
    int quarters;          ///< by which an upright picture becomes that of the camera
    float head_x, head_y;  ///< the way from the pelvis to the head in it
  };
  for (const Mounting& of : {Mounting{K4ABT_SENSOR_ORIENTATION_CLOCKWISE90, 1, 1.F, 0.F},
                             Mounting{K4ABT_SENSOR_ORIENTATION_COUNTERCLOCKWISE90, 3, -1.F, 0.F},
                             Mounting{K4ABT_SENSOR_ORIENTATION_FLIP180, 2, 0.F, 1.F}}) {
    Frame frame = turned(test::rooms()[0], of.quarters);
    frame.quarter_turns = (4 - of.quarters) % 4;
    frame.time_s = seconds(kStep_usec);
    PeopleTracker tracker = make_tracker(detector, {});
    const std::vector<TrackedPerson> expected = found_in(follow(detector, tracker, frame));
    ASSERT_FALSE(expected.empty());
    const Tracker theirs = make_k4abt(calibration_of(frame.camera), kModel, of.orientation);
    const Bodies bodies = next_bodies(theirs, frame, kStep_usec);
    expect_same(expected, detector.body(), frame, bodies);
    const k4abt_skeleton_t skeleton = skeleton_at(bodies, 0);
    const k4a_float3_t &head = skeleton.joints[K4ABT_JOINT_HEAD].position,
                       &pelvis = skeleton.joints[K4ABT_JOINT_PELVIS].position;
    const Eigen::Vector2f up(head.xyz.x - pelvis.xyz.x, head.xyz.y - pelvis.xyz.y);
    EXPECT_GT(up.normalized().dot(Eigen::Vector2f(of.head_x, of.head_y)), 0.9F) << of.quarters;
  }
}

/// Pictures of a lens are straightened, and what is found in them is put back into the bent ones.
// Labels: slow
TEST(K4abt, UndoesTheLensAndPutsBodiesBackBehindIt) {
  const Frame straight = test::rooms()[0];
  k4a_calibration_t calibration = calibration_of(straight.camera);
  calibration.depth_camera_calibration.intrinsics.parameters.param.k1 = -0.15F;
  const Lens lens = *make_lens("rational_polynomial", {-0.15F, 0, 0, 0, 0, 0, 0, 0});
  Frame bent = straight;
  bent.colour = {};
  bent.depth.fill(0);
  const Camera& camera = straight.camera;
  const auto at = [&](const Eigen::Vector2d& ray) {
    const Eigen::Vector2f pixel = camera.pixel({float(ray.x()), float(ray.y()), 1.F});
    return std::pair(int(std::lround(pixel.x())), int(std::lround(pixel.y())));
  };
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto ray = undistort(lens, camera.point(float(u), float(v), 1.F).head<2>().cast<double>());
      const auto [from_u, from_v] = at(ray.value_or(Eigen::Vector2d(9.0, 9.0)));
      if (straight.depth.contains(from_u, from_v)) bent.depth(u, v) = straight.depth(from_u, from_v);
    }
  }
  const Bodies bodies = next_bodies(make_k4abt(calibration, kModel), bent, kStep_usec);
  const Bodies plain = next_bodies(make_k4abt(calibration_of(camera), kModel), depth_frame(straight.depth, camera), 1);
  ASSERT_GE(k4abt_frame_get_num_bodies(bodies.get()), 1U);
  ASSERT_EQ(k4abt_frame_get_num_bodies(bodies.get()), k4abt_frame_get_num_bodies(plain.get()));
  const std::vector<std::uint8_t> map = index_map(bodies), straight_map = index_map(plain);
  long both = 0, either = 0, wrong = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto ray = undistort(lens, camera.point(float(u), float(v), 1.F).head<2>().cast<double>());
      const auto [from_u, from_v] = at(ray.value_or(Eigen::Vector2d(9.0, 9.0)));
      if (!straight.depth.contains(from_u, from_v)) continue;
      const bool here = map[std::size_t(v * camera.width + u)] != 255;
      const bool there = straight_map[std::size_t(from_v * camera.width + from_u)] != 255;
      both += here && there ? 1 : 0;
      either += here || there ? 1 : 0;
      wrong += here && bent.depth(u, v) == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(double(both), 0.9 * double(either));
  EXPECT_LT(double(wrong), 0.1 * double(either));
  for (const int joint : {K4ABT_JOINT_PELVIS, K4ABT_JOINT_NECK, K4ABT_JOINT_SPINE_CHEST}) {
    const k4a_float3_t bent_at = skeleton_at(bodies, 0).joints[joint].position;
    const k4a_float3_t plain_at = skeleton_at(plain, 0).joints[joint].position;
    const float off_mm = (Eigen::Vector3f(bent_at.v) - Eigen::Vector3f(plain_at.v)).norm();
    EXPECT_LT(off_mm, 40.F) << joint;
  }
}

// Labels: slow
TEST(K4abt, SmoothsJointsByTheFactor) {
  const Frame frame = test::rooms()[0];
  test::expect_smoothing([&](float factor) {
    const Tracker tracker = make_k4abt(calibration_of(frame.camera), kModel);
    k4abt_tracker_set_temporal_smoothing(tracker.get(), factor);
    float moved = 0.F;
    std::optional<k4a_float3_t> last;
    for (std::uint64_t i = 1; i <= 6; ++i) {
      Frame shaken = frame;
      shaken.depth = test::shaken(frame.depth, i);
      const k4a_float3_t at =
          skeleton_at(next_bodies(tracker, shaken, i * kStep_usec), 0).joints[K4ABT_JOINT_SPINE_CHEST].position;
      if (last) moved += std::abs(at.xyz.z - last->xyz.z);
      last = at;
    }
    return moved;
  });
}

TEST(K4abt, CountsReferences) {
  const int before = fake_k4a_held();
  {
    const Tracker tracker = quick_tracker();
    Bodies bodies = next_bodies(tracker, quick_frame(), 1);
    const int held = fake_k4a_held();
    EXPECT_EQ(held, before + 2) << "the capture and its depth";
    k4abt_frame_reference(bodies.get());
    k4abt_frame_release(bodies.get());
    const Picture map(k4abt_frame_get_body_index_map(bodies.get())), same(k4abt_frame_get_body_index_map(bodies.get()));
    EXPECT_EQ(map.get(), same.get());
    EXPECT_EQ(k4a_image_get_device_timestamp_usec(map.get()), 1U);
    const Capture capture(k4abt_frame_get_capture(bodies.get()));
    const k4abt_frame_t handle = bodies.get();
    bodies.reset();
    EXPECT_EQ(k4abt_frame_get_num_bodies(handle), 0U) << "it is gone";
    EXPECT_EQ(k4abt_frame_get_body_index_map(handle), nullptr);
    EXPECT_EQ(k4a_image_get_buffer(map.get())[0], 255) << "but not what was taken of it";
    EXPECT_TRUE(Picture(k4a_capture_get_depth_image(capture.get())));
  }
  EXPECT_EQ(fake_k4a_held(), before);
}

TEST(K4abt, FramesOutliveTheirTracker) {
  Tracker tracker = quick_tracker();
  const Bodies bodies = next_bodies(tracker, quick_frame(), 77);
  tracker.reset();
  EXPECT_EQ(k4abt_frame_get_device_timestamp_usec(bodies.get()), 77U);
  EXPECT_THAT(index_map(bodies), testing::Each(255));
}

TEST(K4abt, WaitsForAsLongAsItIsTold) {
  const Tracker tracker = quick_tracker();
  k4abt_frame_t bodies = nullptr;
  using Clock = std::chrono::steady_clock;
  EXPECT_EQ(k4abt_tracker_pop_result(tracker.get(), &bodies, 0), K4A_WAIT_RESULT_TIMEOUT);
  const auto start = Clock::now();
  EXPECT_EQ(k4abt_tracker_pop_result(tracker.get(), &bodies, 60), K4A_WAIT_RESULT_TIMEOUT);
  EXPECT_GE(Clock::now() - start, std::chrono::milliseconds(60));
  EXPECT_EQ(bodies, nullptr);
}

TEST(K4abt, TakesNoMoreThanThereIsRoomForAndLosesNone) {
  const Tracker tracker = quick_tracker();
  std::uint64_t given = 0;
  const auto give = [&](std::int32_t timeout_ms) {
    return k4abt_tracker_enqueue_capture(tracker.get(), capture_of(quick_frame(), given + 1).get(), timeout_ms);
  };
  while (give(500) == K4A_WAIT_RESULT_SUCCEEDED) ASSERT_LT(++given, 20U);
  EXPECT_GE(given, 6U) << "three that wait, and three that were found";
  EXPECT_LE(given, 8U) << "and two that are looked at";
  EXPECT_EQ(give(0), K4A_WAIT_RESULT_TIMEOUT);
  for (std::uint64_t i = 1; i <= given; ++i) {
    k4abt_frame_t bodies = nullptr;
    ASSERT_EQ(k4abt_tracker_pop_result(tracker.get(), &bodies, K4A_WAIT_INFINITE), K4A_WAIT_RESULT_SUCCEEDED);
    EXPECT_EQ(k4abt_frame_get_device_timestamp_usec(Bodies(bodies).get()), i);
  }
  EXPECT_EQ(give(0), K4A_WAIT_RESULT_SUCCEEDED);
}

TEST(K4abt, AfterAShutdownWhatWaitsIsStillGiven) {
  const Tracker tracker = quick_tracker();
  for (std::uint64_t i = 1; i <= 3; ++i) {
    ASSERT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), capture_of(quick_frame(), i).get(), K4A_WAIT_INFINITE),
              K4A_WAIT_RESULT_SUCCEEDED);
  }
  k4abt_tracker_shutdown(tracker.get());
  k4abt_tracker_shutdown(tracker.get());
  EXPECT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), capture_of(quick_frame(), 4).get(), K4A_WAIT_INFINITE),
            K4A_WAIT_RESULT_FAILED);
  for (std::uint64_t i = 1; i <= 3; ++i) {
    k4abt_frame_t bodies = nullptr;
    ASSERT_EQ(k4abt_tracker_pop_result(tracker.get(), &bodies, K4A_WAIT_INFINITE), K4A_WAIT_RESULT_SUCCEEDED);
    EXPECT_EQ(k4abt_frame_get_device_timestamp_usec(Bodies(bodies).get()), i);
  }
  k4abt_frame_t bodies = nullptr;
  EXPECT_EQ(k4abt_tracker_pop_result(tracker.get(), &bodies, K4A_WAIT_INFINITE), K4A_WAIT_RESULT_FAILED);
}

TEST(K4abt, WhoWaitsHearsOfShutdownAndDestruction) {
  for (const bool destroys : {false, true}) {
    Tracker tracker = quick_tracker();
    auto waiting = std::async(std::launch::async, [handle = tracker.get()] {
      k4abt_frame_t bodies = nullptr;
      return k4abt_tracker_pop_result(handle, &bodies, K4A_WAIT_INFINITE);
    });
    EXPECT_EQ(waiting.wait_for(std::chrono::milliseconds(30)), std::future_status::timeout);
    destroys ? tracker.reset() : k4abt_tracker_shutdown(tracker.get());
    EXPECT_EQ(waiting.get(), K4A_WAIT_RESULT_FAILED);
  }
}

TEST(K4abt, TellsWhatIsNoTracker) {
  Tracker tracker = quick_tracker();
  const k4abt_tracker_t gone = tracker.get();
  tracker.reset();
  k4abt_frame_t bodies = nullptr;
  const Capture capture = capture_of(quick_frame(), 1);
  std::size_t something = 0;
  for (const k4abt_tracker_t wrong : {gone, k4abt_tracker_t{}, reinterpret_cast<k4abt_tracker_t>(&something)}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(k4abt_tracker_enqueue_capture(wrong, capture.get(), 0), K4A_WAIT_RESULT_FAILED);
    EXPECT_EQ(k4abt_tracker_pop_result(wrong, &bodies, 0), K4A_WAIT_RESULT_FAILED);
    k4abt_tracker_set_temporal_smoothing(wrong, 0.5F);
    k4abt_tracker_shutdown(wrong);
    k4abt_tracker_destroy(wrong);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::ranges::count(said, '\n'), 5) << said;
    EXPECT_THAT(said, HasSubstr("k4abt_tracker_shutdown: "));
  }
}

TEST(K4abt, TellsWhatIsNoFrame) {
  const Tracker tracker = quick_tracker();
  Bodies bodies = next_bodies(tracker, quick_frame(), 1);
  k4abt_skeleton_t skeleton{};
  EXPECT_EQ(k4abt_frame_get_body_skeleton(bodies.get(), 0, &skeleton), K4A_RESULT_FAILED) << "nobody is in view";
  EXPECT_EQ(k4abt_frame_get_body_id(bodies.get(), 0), K4ABT_INVALID_BODY_ID);
  const k4abt_frame_t gone = bodies.get();
  bodies.reset();
  for (const k4abt_frame_t wrong : {gone, k4abt_frame_t{}}) {
    EXPECT_EQ(k4abt_frame_get_num_bodies(wrong), 0U);
    EXPECT_EQ(k4abt_frame_get_body_skeleton(wrong, 0, &skeleton), K4A_RESULT_FAILED);
    EXPECT_EQ(k4abt_frame_get_body_id(wrong, 0), K4ABT_INVALID_BODY_ID);
    EXPECT_EQ(k4abt_frame_get_device_timestamp_usec(wrong), 0U);
    EXPECT_EQ(k4abt_frame_get_system_timestamp_nsec(wrong), 0U);
    EXPECT_EQ(k4abt_frame_get_body_index_map(wrong), nullptr);
    EXPECT_EQ(k4abt_frame_get_capture(wrong), nullptr);
    k4abt_frame_reference(wrong);
    k4abt_frame_release(wrong);
  }
}

TEST(K4abt, TellsWhatIsNoCapture) {
  const Tracker tracker = quick_tracker();
  EXPECT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), nullptr, 0), K4A_WAIT_RESULT_FAILED);
  k4a_capture_t made = nullptr;
  ASSERT_EQ(k4a_capture_create(&made), K4A_RESULT_SUCCEEDED);
  const Capture empty(made);
  EXPECT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), empty.get(), 0), K4A_WAIT_RESULT_FAILED) << "no depth";
  k4a_capture_set_depth_image(empty.get(), picture_of(DepthImage(8, 8), K4A_IMAGE_FORMAT_DEPTH16).get());
  EXPECT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), empty.get(), 0), K4A_WAIT_RESULT_FAILED) << "another size";
  k4a_capture_set_depth_image(empty.get(), picture_of(quick_frame().depth, K4A_IMAGE_FORMAT_IR16).get());
  EXPECT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), empty.get(), 0), K4A_WAIT_RESULT_FAILED) << "another format";
  const Capture whole = capture_of(quick_frame(), 1);
  k4a_capture_set_color_image(whole.get(), picture_of(DepthImage(8, 8), K4A_IMAGE_FORMAT_COLOR_MJPG).get());
  ASSERT_EQ(k4abt_tracker_enqueue_capture(tracker.get(), whole.get(), 0), K4A_WAIT_RESULT_SUCCEEDED);
  k4abt_frame_t bodies = nullptr;
  EXPECT_EQ(k4abt_tracker_pop_result(tracker.get(), &bodies, K4A_WAIT_INFINITE), K4A_WAIT_RESULT_SUCCEEDED)
      << "damaged colour is left out";
  k4abt_frame_release(bodies);
}

TEST(K4abt, TellsWhatNoTrackerIsMadeOf) {
  const k4a_calibration_t calibration = calibration_of(quick_frame().camera);
  k4abt_tracker_configuration_t config = K4ABT_TRACKER_CONFIG_DEFAULT;
  config.model_path = kQuickModel.c_str();
  std::size_t something = 0;
  const auto said_of = [&](const k4a_calibration_t* of) {
    auto made = reinterpret_cast<k4abt_tracker_t>(&something);
    testing::internal::CaptureStderr();
    EXPECT_EQ(k4abt_tracker_create(of, config, &made), K4A_RESULT_FAILED);
    EXPECT_EQ(made, nullptr);
    std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
    return said;
  };
  EXPECT_EQ(k4abt_tracker_create(&calibration, config, nullptr), K4A_RESULT_FAILED);
  EXPECT_THAT(said_of(nullptr), HasSubstr("sensor_calibration is NULL"));
  k4a_calibration_t wrong = calibration;
  wrong.depth_camera_calibration.resolution_width = 0;
  EXPECT_THAT(said_of(&wrong), HasSubstr("depth camera"));
  wrong = calibration;
  wrong.depth_camera_calibration.intrinsics.parameters.param.fx = NAN;
  EXPECT_THAT(said_of(&wrong), HasSubstr("depth camera"));
  wrong = calibration;
  wrong.depth_camera_calibration.intrinsics.type = K4A_CALIBRATION_LENS_DISTORTION_MODEL_THETA;
  EXPECT_THAT(said_of(&wrong), HasSubstr("lens of type 1"));
  const int no_orientation = 7;
  std::memcpy(&config.sensor_orientation, &no_orientation, sizeof no_orientation);
  EXPECT_THAT(said_of(&calibration), HasSubstr("sensor_orientation is 7"));
  config.sensor_orientation = K4ABT_SENSOR_ORIENTATION_DEFAULT;
  config.model_path = "/nowhere/my.model";
  EXPECT_THAT(said_of(&calibration), HasSubstr("/nowhere/my.model"));
}

/// The model that a program names for Microsoft's library stands for the one that is used here.
TEST(K4abt, TakesTheUsualModelForAnotherLibrarysOwn) {
  const k4a_calibration_t calibration = calibration_of(quick_frame().camera);
  k4abt_tracker_configuration_t config = K4ABT_TRACKER_CONFIG_DEFAULT;
  config.gpu_device_id = 3;
  setenv("VESALIUS_MODEL", kQuickModel.c_str(), 1);
  for (const char* path : {static_cast<const char*>(nullptr), "", "dnn_model_2_0_op11.onnx"}) {
    config.model_path = path;
    k4abt_tracker_t made = nullptr;
    EXPECT_EQ(k4abt_tracker_create(&calibration, config, &made), K4A_RESULT_SUCCEEDED);
    k4abt_tracker_destroy(made);
  }
  unsetenv("VESALIUS_MODEL");
}

// Labels: threads
TEST(K4abt, EightThreadsHaveTheirOwnTrackersAndShareFrames) {
  const int before = fake_k4a_held();
  {
    const Tracker shared = quick_tracker();
    const Bodies seen_by_all = next_bodies(shared, quick_frame(), 42);
    std::atomic<int> right = 0;
    std::vector<std::thread> threads;
    for (std::uint64_t t = 1; t <= 8; ++t) {
      threads.emplace_back([&, t] {
        const Tracker own = quick_tracker();
        for (std::uint64_t i = 0; i < 5; ++i) {
          const Bodies bodies = next_bodies(own, quick_frame(), t * 1000 + i);
          k4abt_frame_reference(seen_by_all.get());
          const bool same = k4abt_frame_get_device_timestamp_usec(bodies.get()) == t * 1000 + i &&
                            index_map(seen_by_all).size() == quick_frame().depth.size();
          k4abt_frame_release(seen_by_all.get());
          k4abt_tracker_set_temporal_smoothing(own.get(), 0.3F);
          right += same ? 1 : 0;
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(right, 40);
  }
  EXPECT_EQ(fake_k4a_held(), before);
}

// Labels: threads
TEST(K4abt, OneTrackerServesSeveralThreads) {
  const Tracker tracker = quick_tracker();
  constexpr int kFrames = 24;
  std::atomic<int> given = 0, taken = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < kFrames / 4; ++i) {
        const Capture capture = capture_of(quick_frame(), 1);
        given += k4abt_tracker_enqueue_capture(tracker.get(), capture.get(), K4A_WAIT_INFINITE) == 0 ? 1 : 0;
      }
    });
    threads.emplace_back([&] {
      for (int i = 0; i < kFrames / 4; ++i) {
        k4abt_frame_t bodies = nullptr;
        taken += k4abt_tracker_pop_result(tracker.get(), &bodies, K4A_WAIT_INFINITE) == 0 ? 1 : 0;
        k4abt_frame_release(bodies);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(given, kFrames);
  EXPECT_EQ(taken, kFrames);
}

/// Programs in C and C++ that were written for the interface say of a recording what the C++ tracker does.
// Labels: slow
TEST(K4abt, ProgramsOfTheInterfaceRun) {
  const test::TemporaryFolder folder;
  const Detector detector(load_model(kModel));
  PeopleTracker tracker = make_tracker(detector, {});
  const std::size_t set = find_joint_set(detector.body(), "k4abt32");
  const k4a_calibration_t calibration = calibration_of(test::rooms()[0].camera);
  std::ofstream file(folder / "recording", std::ios::binary);
  file.write(reinterpret_cast<const char*>(&calibration), sizeof calibration);
  std::string expected;
  std::uint64_t usec = 1'000'000;
  for (Frame frame : test::rooms()) {
    frame.colour = {};
    frame.time_s = seconds(usec);
    file.write(reinterpret_cast<const char*>(&usec), sizeof usec);
    file.write(reinterpret_cast<const char*>(frame.depth.data()), std::streamsize(frame.depth.size() * 2));
    const auto people = found_in(follow(detector, tracker, frame));
    const auto map = body_index_map(only_people(people), frame.camera.width, frame.camera.height);
    expected += "frame " + std::to_string(usec) + "\n";
    for (std::size_t i = 0; i < people.size(); ++i) {
      const Joint& head = people[i].person.joints[set][K4ABT_JOINT_HEAD];
      std::array<char, 128> line{};
      std::snprintf(line.data(), line.size(), "%d: %.3f %.3f %.3f %d, %ld\n", people[i].id,
                    double(1000.F * head.position.x()), double(1000.F * head.position.y()),
                    double(1000.F * head.position.z()), head.confidence < 0.5F ? 1 : 2,
                    long(std::ranges::count(map, static_cast<std::uint8_t>(i))));
      expected += line.data();
    }
    usec += kStep_usec;
  }
  file.close();
  EXPECT_THAT(expected, HasSubstr("\n1: "));
  EXPECT_EQ(test::output_of("FAKE_K4A='" + (folder / "recording") + "' " VESALIUS_LIVE_LOOP), expected);
  EXPECT_EQ(test::output_of(VESALIUS_OFFLINE_PROCESSOR " '" + (folder / "recording") + "'"), expected);
}

}  // namespace
}  // namespace vesalius
