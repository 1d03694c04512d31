// libvesalius.so as programs call it, beside the C++ detector of the libraries that it is made of.

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "io/files/options_file.h"
#include "io/lens/lens.h"
#include "io/sources/test_rooms.h"
#include "vesalius/detect.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"
#include "vesalius/track_people.h"
#include "vesalius/vesalius.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

const std::string kData = std::string(VESALIUS_SOURCE_DIR) + "/data/";
const std::string kModel = kData + "models/default.model";
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <class T, void (*destroy)(T*)>
struct Destroy {
  void operator()(T* handle) const { destroy(handle); }
};
using Options = std::unique_ptr<vesalius_options, Destroy<vesalius_options, vesalius_options_destroy>>;
using CDetector = std::unique_ptr<vesalius_detector, Destroy<vesalius_detector, vesalius_detector_destroy>>;
using CTracker = std::unique_ptr<vesalius_tracker, Destroy<vesalius_tracker, vesalius_tracker_destroy>>;
using CPeople = std::unique_ptr<vesalius_people, Destroy<vesalius_people, vesalius_people_destroy>>;

Options make_options() {
  vesalius_options* made = nullptr;
  EXPECT_EQ(vesalius_options_create(&made), VESALIUS_OK);
  return Options(made);
}

CDetector make_detector(const std::string& model = kModel, const vesalius_options* options = nullptr) {
  vesalius_detector* made = nullptr;
  EXPECT_EQ(vesalius_detector_create(model.c_str(), options, 0, nullptr, &made), VESALIUS_OK) << vesalius_last_error();
  return CDetector(made);
}

const vesalius_detector* usual_detector() {
  static const CDetector detector = make_detector();
  return detector.get();
}

/// A small forest is enough where only calls matter.
const vesalius_detector* quick_detector() {
  static const CDetector detector = make_detector(kData + "models/capsule.forest");
  return detector.get();
}

CTracker make_tracker(const vesalius_detector* detector) {
  vesalius_tracker* made = nullptr;
  EXPECT_EQ(vesalius_tracker_create(detector, &made), VESALIUS_OK);
  return CTracker(made);
}

vesalius_camera camera_of(const Camera& camera) {
  vesalius_camera given{};
  given.struct_size = sizeof given;
  given.width = camera.width;
  given.height = camera.height;
  given.fx = camera.fx;
  given.fy = camera.fy;
  given.cx = camera.cx;
  given.cy = camera.cy;
  return given;
}

/// Points into the frame.
vesalius_frame frame_of(const Frame& frame) {
  vesalius_frame given{};
  given.struct_size = sizeof given;
  given.depth = frame.depth.data();
  given.colour = frame.colour.empty() ? nullptr : &frame.colour.data()->r;
  given.has_time = frame.time_s ? 1 : 0;
  given.time_s = frame.time_s.value_or(0.0);
  return given;
}

CPeople detect(const vesalius_detector* detector, const vesalius_frame& frame, const vesalius_camera& camera) {
  vesalius_people* people = nullptr;
  EXPECT_EQ(vesalius_detector_detect(detector, &frame, &camera, &people), VESALIUS_OK) << vesalius_last_error();
  return CPeople(people);
}

vesalius_person person_at(const CPeople& people, int index) {
  vesalius_person person{};
  person.struct_size = sizeof person;
  EXPECT_EQ(vesalius_people_get(people.get(), index, &person), VESALIUS_OK);
  return person;
}

/// Asks for the length first, as a program may.
template <class T, class Give>
std::vector<T> array_of(const Give& give) {
  int32_t count = -1;
  EXPECT_EQ(give(nullptr, 0, &count), VESALIUS_OK);
  std::vector<T> values(static_cast<std::size_t>(count));
  EXPECT_EQ(give(values.data(), count, &count), VESALIUS_OK);
  EXPECT_EQ(static_cast<std::size_t>(count), values.size());
  return values;
}

std::vector<vesalius_joint> joints_at(const CPeople& people, int index, const char* set = nullptr) {
  return array_of<vesalius_joint>([&](vesalius_joint* to, int32_t capacity, int32_t* count) {
    return vesalius_people_joints(people.get(), index, set, to, capacity, count);
  });
}

template <class Picture>
std::vector<std::uint8_t> picture_at(const CPeople& people, int index, Picture picture) {
  return array_of<std::uint8_t>([&](std::uint8_t* to, int32_t capacity, int32_t* count) {
    return picture(people.get(), index, to, capacity, count);
  });
}

/// Every byte that the interface gives of the people.
std::string bytes_of(const CPeople& people) {
  std::string bytes;
  const auto add = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
  };
  for (int i = 0; i < vesalius_people_count(people.get()); ++i) {
    add(std::array{person_at(people, i)});
    add(joints_at(people, i));
    add(picture_at(people, i, vesalius_people_mask));
    add(picture_at(people, i, vesalius_people_labels));
  }
  return bytes;
}

bool same_float(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)); }

void expect_place(const Eigen::Vector3f& expected, State state, const float* place) {
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(same_float(place[axis], state == State::none ? kNan : expected[axis])) << place[axis];
  }
}

void expect_picture(const Image<std::uint8_t>& expected, std::uint8_t outside, const Frame& frame,
                    const std::vector<std::uint8_t>& found) {
  const Image<std::uint8_t> whole =
      expected.empty() ? Image<std::uint8_t>(frame.camera.width, frame.camera.height, outside) : expected;
  EXPECT_TRUE(std::equal(whole.begin(), whole.end(), found.begin(), found.end()));
}

/// Expects why joints or parts are not observed.
template <class Point>
void expect_reasons(const std::vector<Point>& expected, const std::vector<vesalius_unseen>& given) {
  ASSERT_EQ(given.size(), expected.size());
  for (std::size_t i = 0; i < given.size(); ++i) {
    EXPECT_EQ(given[i].why, static_cast<int>(expected[i].unseen));
    EXPECT_EQ(given[i].behind, expected[i].behind);
    EXPECT_EQ(given[i].why == VESALIUS_UNSEEN_NONE, expected[i].state == State::observed);
    EXPECT_EQ(given[i].why == VESALIUS_UNSEEN_BEHIND_PERSON, given[i].behind >= 0);
  }
}

void expect_same(const Person& expected, const BodyModel& body, const Frame& frame, const CPeople& people, int index) {
  const vesalius_person person = person_at(people, index);
  EXPECT_TRUE(same_float(person.score, expected.score));
  EXPECT_EQ(person.box_u, expected.box.u);
  EXPECT_EQ(person.box_v, expected.box.v);
  EXPECT_EQ(person.box_width, expected.box.width);
  EXPECT_EQ(person.box_height, expected.box.height);
  EXPECT_TRUE(same_float(person.yaw_rad, expected.yaw ? expected.yaw->yaw_rad : kNan));
  for (std::size_t s = 0; s < body.joint_sets.size(); ++s) {
    const auto joints = joints_at(people, index, body.joint_sets[s].name.c_str());
    ASSERT_EQ(joints.size(), expected.joints[s].size());
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Joint& joint = expected.joints[s][j];
      expect_place(joint.position, joint.state, &joints[j].x_m);
      EXPECT_TRUE(same_float(joints[j].confidence, joint.confidence));
      EXPECT_EQ(joints[j].state, static_cast<int>(joint.state));
    }
    expect_reasons(expected.joints[s],
                   array_of<vesalius_unseen>([&](vesalius_unseen* to, int32_t capacity, int32_t* count) {
                     return vesalius_people_joints_unseen(people.get(), index, body.joint_sets[s].name.c_str(), to,
                                                          capacity, count);
                   }));
  }
  const auto parts = array_of<vesalius_part>([&](vesalius_part* to, int32_t capacity, int32_t* count) {
    return vesalius_people_parts(people.get(), index, to, capacity, count);
  });
  ASSERT_EQ(parts.size(), expected.skeleton.parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const SkeletonPart& part = expected.skeleton.parts[p];
    expect_place(part.centre, part.state, &parts[p].x_m);
    expect_place(part.extent_m, State::observed, parts[p].extent_m);
    EXPECT_TRUE(same_float(parts[p].confidence, part.confidence));
    EXPECT_EQ(parts[p].state, static_cast<int>(part.state));
  }
  expect_reasons(expected.skeleton.parts,
                 array_of<vesalius_unseen>([&](vesalius_unseen* to, int32_t capacity, int32_t* count) {
                   return vesalius_people_parts_unseen(people.get(), index, to, capacity, count);
                 }));
  expect_picture(expected.mask, 0, frame, picture_at(people, index, vesalius_people_mask));
  expect_picture(expected.labels, kBackground, frame, picture_at(people, index, vesalius_people_labels));
}

/// Expects the fitted body of a person, or that there is none.
void expect_same_body(const TrackedPerson& expected, const BodyModel& body, const CPeople& people, int index) {
  const vesalius_person person = person_at(people, index);
  EXPECT_EQ(person.stance, static_cast<int>(expected.stance));
  EXPECT_TRUE(same_float(person.stature_m, expected.body ? expected.body->stature_m : kNan));
  const auto bones = array_of<vesalius_bone>([&](vesalius_bone* to, int32_t capacity, int32_t* count) {
    return vesalius_people_bones(people.get(), index, to, capacity, count);
  });
  ASSERT_EQ(bones.size(), expected.body ? expected.body->bones.size() : 0U);
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const FittedBone& bone = expected.body->bones[b];
    expect_place(bone.head, State::observed, bones[b].head_m);
    expect_place(bone.tail, State::observed, bones[b].tail_m);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(same_float(bones[b].rotation_xyzw[i], bone.global.coeffs()[i]));
    EXPECT_TRUE(same_float(bones[b].length_m, bone.length_m));
    EXPECT_TRUE(same_float(bones[b].confidence, bone.confidence));
    EXPECT_EQ(bones[b].state, static_cast<int>(bone.state));
  }
  for (const JointSet& set : body.joint_sets) {
    const auto rotations = array_of<vesalius_rotation>([&](vesalius_rotation* to, int32_t capacity, int32_t* count) {
      return vesalius_people_rotations(people.get(), index, set.name.c_str(), to, capacity, count);
    });
    ASSERT_EQ(rotations.size(), set.joints.size());
    std::vector<std::optional<Eigen::Quaternionf>> known(set.joints.size());
    if (expected.body) known = joint_rotations(*expected.body, builtin_flesh_joints(), set);
    for (std::size_t j = 0; j < known.size(); ++j) {
      EXPECT_TRUE(same_float(rotations[j].x, known[j] ? known[j]->x() : kNan));
      EXPECT_TRUE(same_float(rotations[j].w, known[j] ? known[j]->w() : kNan));
    }
  }
}

// Labels: slow
TEST(CLibrary, FindsTheSamePeopleAsTheDetectorToTheBit) {
  const Detector detector(load_model(kModel));
  ASSERT_FALSE(test::rooms().empty());
  int found = 0;
  for (const Frame& frame : test::rooms()) {
    const std::vector<Person> expected = detector.detect(frame);
    const CPeople people = detect(usual_detector(), frame_of(frame), camera_of(frame.camera));
    ASSERT_EQ(vesalius_people_count(people.get()), static_cast<int>(expected.size())) << frame.name;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      expect_same(expected[i], detector.body(), frame, people, static_cast<int>(i));
      const vesalius_person person = person_at(people, static_cast<int>(i));
      EXPECT_EQ(person.id, 0);
      EXPECT_EQ(person.state, VESALIUS_PERSON_SEEN);
      EXPECT_TRUE(std::isnan(person.velocity_m_s[0]));
      ++found;
    }
  }
  EXPECT_GE(found, 6);
}

// Labels: slow
TEST(CLibrary, FollowsPeopleAsTheTrackerToTheBit) {
  const Detector detector(load_model(kModel));
  PeopleTracker tracker = make_tracker(detector, {});
  const CTracker c_tracker = make_tracker(usual_detector());
  int hidden = 0, fitted = 0;
  // Thrice the same frame, so that people are sure, and one without them.
  for (const std::size_t which : {0, 0, 0, 1, 2}) {
    Frame frame = test::rooms().at(which);
    if (which == 1) frame.depth.fill(4000);
    const TrackedFrame expected = follow(detector, tracker, frame);
    const vesalius_frame given = frame_of(frame);
    const vesalius_camera camera = camera_of(frame.camera);
    vesalius_people* made = nullptr;
    ASSERT_EQ(vesalius_tracker_update(c_tracker.get(), &given, &camera, &made), VESALIUS_OK) << vesalius_last_error();
    const CPeople people(made);
    ASSERT_EQ(vesalius_people_count(made), static_cast<int>(expected.people.size()));
    for (std::size_t i = 0; i < expected.people.size(); ++i) {
      const TrackedPerson& theirs = expected.people[i];
      expect_same(theirs.person, detector.body(), frame, people, static_cast<int>(i));
      const vesalius_person person = person_at(people, static_cast<int>(i));
      EXPECT_EQ(person.id, theirs.id);
      EXPECT_EQ(person.state, static_cast<int>(theirs.state));
      for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(same_float(person.velocity_m_s[axis], theirs.velocity[axis]));
      expect_same_body(theirs, detector.body(), people, static_cast<int>(i));
      fitted += theirs.body ? 1 : 0;
      hidden += person.state == VESALIUS_PERSON_HIDDEN ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 0);
  EXPECT_GT(fitted, 0);
}

TEST(CLibrary, NamesPartsAndJointsAsTheBody) {
  const BodyModel body = load_model(kModel).body;
  const vesalius_detector* detector = usual_detector();
  ASSERT_EQ(vesalius_detector_part_count(detector), body.part_count());
  for (int p = 0; p < body.part_count(); ++p) EXPECT_EQ(vesalius_detector_part_name(detector, p), body.parts[p].name);
  ASSERT_EQ(vesalius_detector_joint_set_count(detector), static_cast<int>(body.joint_sets.size()));
  for (std::size_t s = 0; s < body.joint_sets.size(); ++s) {
    const JointSet& set = body.joint_sets[s];
    ASSERT_EQ(vesalius_detector_joint_set_name(detector, static_cast<int>(s)), set.name);
    ASSERT_EQ(vesalius_detector_joint_count(detector, set.name.c_str()), static_cast<int>(set.joints.size()));
    for (std::size_t j = 0; j < set.joints.size(); ++j) {
      EXPECT_EQ(vesalius_detector_joint_name(detector, set.name.c_str(), static_cast<int>(j)), set.joints[j].name);
    }
  }
  EXPECT_EQ(vesalius_detector_joint_count(detector, nullptr), 32);
  EXPECT_STREQ(vesalius_detector_joint_name(detector, nullptr, 0),
               vesalius_detector_joint_name(detector, "k4abt32", 0));
}

TEST(CLibrary, NamesBonesAsTheFlesh) {
  const vesalius_detector* detector = usual_detector();
  const std::vector<FleshBone>& bones = builtin_flesh().bones;
  ASSERT_EQ(vesalius_detector_bone_count(detector), static_cast<int>(bones.size()));
  for (std::size_t b = 0; b < bones.size(); ++b) {
    EXPECT_EQ(vesalius_detector_bone_name(detector, static_cast<int>(b)), bones[b].name);
    EXPECT_EQ(vesalius_detector_bone_parent(detector, static_cast<int>(b)), bones[b].parent);
  }
  for (const int index : {-1, static_cast<int>(bones.size())}) {
    EXPECT_EQ(vesalius_detector_bone_name(detector, index), nullptr);
    EXPECT_EQ(vesalius_detector_bone_parent(detector, index), -1);
    EXPECT_THAT(vesalius_last_error(), HasSubstr("bone " + std::to_string(index) + " is not there"));
  }
  EXPECT_EQ(vesalius_detector_bone_count(nullptr), -1);
  EXPECT_EQ(vesalius_detector_bone_name(nullptr, 0), nullptr);
}

/// The first of the rooms in a way of storing it, and the same people in it.
class Layout : public testing::Test {
 protected:
  const Frame& frame_ = test::rooms().front();
  const std::size_t width_ = static_cast<std::size_t>(frame_.camera.width);
  const std::size_t height_ = static_cast<std::size_t>(frame_.camera.height);
  const vesalius_camera camera_ = camera_of(frame_.camera);
  vesalius_frame given_ = frame_of(frame_);

  /// Returns the picture with so many bytes after each row, one byte off any alignment, top row first or last.
  template <class T>
  std::vector<unsigned char> padded(const std::vector<T>& pixels, std::size_t gap, bool bottom_up) const {
    const std::size_t row = pixels.size() / height_ * sizeof(T), stride = row + gap;
    std::vector<unsigned char> bytes(1 + stride * height_, 0xEE);
    for (std::size_t v = 0; v < height_; ++v) {
      const std::size_t to = bottom_up ? height_ - 1 - v : v;
      std::memcpy(&bytes[1 + to * stride], reinterpret_cast<const char*>(pixels.data()) + v * row, row);
    }
    return bytes;
  }
  std::string usual() const { return bytes_of(detect(usual_detector(), frame_of(frame_), camera_)); }
  void expect_usual() const { EXPECT_TRUE(bytes_of(detect(usual_detector(), given_, camera_)) == usual()); }
};

TEST_F(Layout, HasRowsWithGapsAndOutOfAlignment) {
  const auto depth = padded(std::vector<std::uint16_t>(frame_.depth.begin(), frame_.depth.end()), 7, false);
  const auto colour = padded(std::vector<Rgb>(frame_.colour.begin(), frame_.colour.end()), 5, false);
  given_.depth = &depth[1];
  given_.depth_stride = static_cast<int64_t>(width_ * 2 + 7);
  given_.colour = &colour[1];
  given_.colour_stride = static_cast<int64_t>(width_ * 3 + 5);
  expect_usual();
}

TEST_F(Layout, MayBeBottomUp) {
  const auto depth = padded(std::vector<std::uint16_t>(frame_.depth.begin(), frame_.depth.end()), 0, true);
  const auto colour = padded(std::vector<Rgb>(frame_.colour.begin(), frame_.colour.end()), 2, true);
  given_.depth_stride = -static_cast<int64_t>(width_ * 2);
  given_.depth = &depth[1 + (height_ - 1) * width_ * 2];
  given_.colour_stride = -static_cast<int64_t>(width_ * 3 + 2);
  given_.colour = &colour[1 + (height_ - 1) * (width_ * 3 + 2)];
  expect_usual();
}

TEST_F(Layout, MayBeMetres) {
  std::vector<float> metres(frame_.depth.size());
  for (std::size_t i = 0; i < metres.size(); ++i) {
    constexpr std::array kNone = {0.F, kNan, -1.F, std::numeric_limits<float>::infinity()};
    metres[i] = frame_.depth[i] == 0 ? kNone[i % kNone.size()] : static_cast<float>(frame_.depth[i]) * 1e-3F;
  }
  const auto bytes = padded(metres, 3, false);
  given_.depth_format = VESALIUS_DEPTH_METRES;
  given_.depth = &bytes[1];
  given_.depth_stride = static_cast<int64_t>(width_ * 4 + 3);
  expect_usual();
}

TEST_F(Layout, MayHaveOtherOrdersOfColours) {
  for (const int format : {VESALIUS_COLOUR_BGR, VESALIUS_COLOUR_RGBA, VESALIUS_COLOUR_BGRA}) {
    std::vector<std::uint8_t> colour;
    for (const Rgb& pixel : frame_.colour) {
      const bool red_first = format == VESALIUS_COLOUR_RGBA;
      colour.insert(colour.end(), {red_first ? pixel.r : pixel.b, pixel.g, red_first ? pixel.b : pixel.r});
      if (format != VESALIUS_COLOUR_BGR) colour.push_back(static_cast<std::uint8_t>(colour.size()));
    }
    given_.colour = colour.data();
    given_.colour_format = format;
    expect_usual();
  }
}

TEST_F(Layout, LeavesColourOut) {
  given_.colour = nullptr;
  given_.colour_stride = 5;  // of what is not there
  Frame without = frame_;
  without.colour = {};
  const std::vector<Person> expected = Detector(load_model(kModel)).detect(without);
  const CPeople people = detect(usual_detector(), given_, camera_);
  ASSERT_EQ(vesalius_people_count(people.get()), static_cast<int>(expected.size()));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    expect_same(expected[i], load_model(kModel).body, frame_, people, static_cast<int>(i));
  }
}

TEST_F(Layout, UndoesTheLens) {
  vesalius_camera camera = camera_;
  camera.lens = VESALIUS_LENS_BROWN_CONRADY;
  camera.distortion[0] = 0.1;
  camera.distortion[1] = -0.05;
  const Rectification rectification({frame_.camera, *make_lens("plumb_bob", {0.1, -0.05, 0, 0, 0})}, frame_.camera);
  Frame expected = frame_;
  expected.depth = rectification.depth(frame_.depth);
  expected.colour = rectification.colour(frame_.colour);
  const std::string bytes = bytes_of(detect(usual_detector(), given_, camera));
  EXPECT_TRUE(bytes == bytes_of(detect(usual_detector(), frame_of(expected), camera_)));
  EXPECT_FALSE(bytes == usual());
  EXPECT_TRUE(bytes == bytes_of(detect(usual_detector(), given_, camera))) << "what undoes it is kept";
}

// Labels: threads
TEST(CLibrary, GivesTheSameFromTenThreads) {
  const Frame frame = open_source(kData + "sample")->next().value();
  const auto bytes = [&] { return bytes_of(detect(quick_detector(), frame_of(frame), camera_of(frame.camera))); };
  const std::string expected = bytes();
  EXPECT_FALSE(expected.empty());
  std::array<std::string, 10> found;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < found.size(); ++i) {
    threads.emplace_back([&, i] {
      vesalius_detector_joint_count(quick_detector(), ("set " + std::to_string(i)).c_str());
      found[i] = bytes();
      // Another thread's errors are not mine.
      if (!std::strstr(vesalius_last_error(), ("\"set " + std::to_string(i) + "\"").c_str())) found[i].clear();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& each : found) EXPECT_TRUE(each == expected);
}

TEST(CLibrary, LetsPeopleAndTrackersOutliveTheirDetector) {
  CDetector detector = make_detector(kData + "models/capsule.forest");
  const CTracker tracker = make_tracker(detector.get());
  const Frame frame = open_source(kData + "sample")->next().value();
  const vesalius_frame given = frame_of(frame);
  const vesalius_camera camera = camera_of(frame.camera);
  const CPeople people = detect(detector.get(), given, camera);
  const std::string before = bytes_of(people);
  EXPECT_FALSE(before.empty());
  detector.reset();
  EXPECT_TRUE(bytes_of(people) == before);
  vesalius_people* followed = nullptr;
  ASSERT_EQ(vesalius_tracker_update(tracker.get(), &given, &camera, &followed), VESALIUS_OK);
  EXPECT_GT(vesalius_people_count(followed), 0);
  vesalius_people_destroy(followed);
}

TEST(CLibrary, HasTheOptionsOfTheProgram) {
  PeopleOptions defaults;
  const auto expected = list_options([&](OptionVisitor& visitor) { visit_options("", defaults, visitor); });
  const Options options = make_options();
  ASSERT_EQ(vesalius_options_count(options.get()), static_cast<int>(expected.size()));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    vesalius_option option{};
    option.struct_size = sizeof option;
    ASSERT_EQ(vesalius_options_get(options.get(), static_cast<int>(i), &option), VESALIUS_OK);
    EXPECT_EQ(option.name, expected[i].name);
    EXPECT_EQ(option.value, expected[i].value);
    EXPECT_EQ(option.kind, static_cast<int>(expected[i].kind));
    EXPECT_STREQ(option.unit, expected[i].info.unit);
    EXPECT_STREQ(option.help, expected[i].info.help);
    EXPECT_EQ(option.low, expected[i].info.low);
    EXPECT_EQ(option.high, expected[i].info.high);
  }
}

std::string value_of(const Options& options, const std::string& name) {
  for (int i = 0; i < vesalius_options_count(options.get()); ++i) {
    vesalius_option option{};
    option.struct_size = sizeof option;
    vesalius_options_get(options.get(), i, &option);
    if (name == option.name) return option.value;
  }
  return "no such option";
}

TEST(CLibrary, DetectsWithTheOptionsThatAreSet) {
  const Options options = make_options();
  ASSERT_EQ(vesalius_options_set(options.get(), "refine.min-score", "1"), VESALIUS_OK);
  EXPECT_EQ(value_of(options, "refine.min-score"), "1.0");
  const std::string file = testing::TempDir() + "c_options.toml";
  std::ofstream(file) << "[refine]\nmax-candidates = 1\n";
  ASSERT_EQ(vesalius_options_load(options.get(), file.c_str()), VESALIUS_OK);
  EXPECT_EQ(value_of(options, "refine.max-candidates"), "1");
  EXPECT_EQ(value_of(options, "refine.min-score"), "1.0");
  const CDetector strict = make_detector(kModel, options.get());
  for (const Frame& frame : test::rooms()) {
    const CPeople nobody = detect(strict.get(), frame_of(frame), camera_of(frame.camera));
    EXPECT_EQ(vesalius_people_count(nobody.get()), 0);
  }
}

TEST(CLibrary, FindsTheModelThatComesWithIt) {
  ::unsetenv("VESALIUS_MODELS");
  vesalius_detector* detector = nullptr;
  // Without a card "auto" is the processor.
  ASSERT_EQ(vesalius_detector_create(nullptr, nullptr, 1, "auto", &detector), VESALIUS_OK) << vesalius_last_error();
  EXPECT_EQ(vesalius_detector_part_count(detector), load_model(kModel).body.part_count());
  vesalius_detector_destroy(detector);
}

TEST(CLibrary, HasAVersion) {
  EXPECT_EQ(vesalius_version(), std::to_string(VESALIUS_VERSION_MAJOR) + "." + std::to_string(VESALIUS_VERSION_MINOR) +
                                    "." + std::to_string(VESALIUS_VERSION_PATCH));
  EXPECT_EQ(vesalius_abi_version(), VESALIUS_ABI_VERSION);
}

TEST(CLibrary, DestroysNull) {
  vesalius_options_destroy(nullptr);
  vesalius_detector_destroy(nullptr);
  vesalius_tracker_destroy(nullptr);
  vesalius_people_destroy(nullptr);
}

/// Calls that must fail, and everything that they need to succeed.
class CErrors : public testing::Test {
 protected:
  const Frame& frame_ = test::rooms().front();
  vesalius_camera camera_ = camera_of(frame_.camera);
  vesalius_frame given_ = frame_of(frame_);
  vesalius_people* const untouched_ = reinterpret_cast<vesalius_people*>(this);
  const CTracker tracker_ = make_tracker(quick_detector());

  void expect_error(vesalius_status found, vesalius_status status, const std::string& why) {
    EXPECT_EQ(found, status) << why;
    EXPECT_THAT(vesalius_last_error(), HasSubstr(why));
    EXPECT_EQ(std::strchr(vesalius_last_error(), '\n'), nullptr);
  }
  /// Expects detector and tracker to refuse the frame.
  void expect_refused(const std::string& why, const vesalius_frame* frame, const vesalius_camera* camera) {
    vesalius_people* people = untouched_;
    expect_error(vesalius_detector_detect(quick_detector(), frame, camera, &people), VESALIUS_ERROR_ARGUMENT, why);
    EXPECT_EQ(people, nullptr);
    people = untouched_;
    expect_error(vesalius_tracker_update(tracker_.get(), frame, camera, &people), VESALIUS_ERROR_ARGUMENT, why);
    EXPECT_EQ(people, nullptr);
  }
  template <class Change>
  void expect_frame_refused(const std::string& why, const Change& change) {
    vesalius_frame frame = given_;
    change(frame);
    expect_refused(why, &frame, &camera_);
  }
  template <class Change>
  void expect_camera_refused(const std::string& why, const Change& change) {
    vesalius_camera camera = camera_;
    change(camera);
    expect_refused(why, &given_, &camera);
  }
};

TEST_F(CErrors, OfFrames) {
  expect_refused("frame is NULL", nullptr, &camera_);
  expect_frame_refused("frame: struct_size is 0, expected 72", [](auto& f) { f.struct_size = 0; });
  expect_frame_refused("frame: struct_size", [](auto& f) { f.struct_size = 1U << 31U; });
  expect_frame_refused("frame: depth is NULL", [](auto& f) { f.depth = nullptr; });
  expect_frame_refused("frame: depth_format is 2, expected 0 to 1", [](auto& f) { f.depth_format = 2; });
  expect_frame_refused("frame: depth_format is -1", [](auto& f) { f.depth_format = -1; });
  expect_frame_refused("frame: depth_stride is 1279, expected 0 or at least 1280",
                       [](auto& f) { f.depth_stride = 1279; });
  expect_frame_refused("frame: depth_stride is -5", [](auto& f) { f.depth_stride = -5; });
  expect_frame_refused("frame: colour_stride is 1919", [](auto& f) { f.colour_stride = 1919; });
  expect_frame_refused("frame: colour_format is 4", [](auto& f) { f.colour_format = 4; });
  expect_frame_refused("frame: colour_format is -9", [](auto& f) { f.colour_format = -9; });
  for (const double time : {std::nan(""), HUGE_VAL}) {
    expect_frame_refused("frame: time_s is not finite", [&](auto& f) { f.has_time = 1, f.time_s = time; });
  }
  for (const float x : {0.F, kNan, std::numeric_limits<float>::infinity()}) {
    expect_frame_refused("frame: up is no direction", [&](auto& f) { f.has_up = 1, f.up[0] = x; });
  }
}

TEST_F(CErrors, OfCameras) {
  expect_refused("camera is NULL", &given_, nullptr);
  expect_camera_refused("camera: struct_size is 8, expected 96", [](auto& c) { c.struct_size = 8; });
  for (const int side : {0, -1, 16001, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    expect_camera_refused("camera: picture size", [&](auto& c) { c.width = side; });
    expect_camera_refused("camera: picture size", [&](auto& c) { c.height = side; });
  }
  for (const float focal : {0.F, -1.F, kNan, std::numeric_limits<float>::infinity()}) {
    expect_camera_refused("camera: focal length", [&](auto& c) { c.fx = focal; });
    expect_camera_refused("camera: focal length", [&](auto& c) { c.fy = focal; });
  }
  expect_camera_refused("camera: principal point", [](auto& c) { c.cx = kNan; });
  expect_camera_refused("camera: principal point", [](auto& c) { c.cy = -std::numeric_limits<float>::infinity(); });
  expect_camera_refused("camera: lens is 4, expected 0 to 3", [](auto& c) { c.lens = 4; });
  expect_camera_refused("camera: lens is -1", [](auto& c) { c.lens = -1; });
  expect_camera_refused("camera: distortion[0] is 0.1", [](auto& c) { c.distortion[0] = 0.1; });
  expect_camera_refused("camera: distortion[4] is", [](auto& c) { c.lens = 3, c.distortion[4] = 1.0; });
  expect_camera_refused("camera: distortion[1] is nan", [](auto& c) { c.lens = 1, c.distortion[1] = std::nan(""); });
}

TEST_F(CErrors, OfHandlesThatAreNull) {
  vesalius_people* people = nullptr;
  expect_error(vesalius_detector_detect(nullptr, &given_, &camera_, &people), VESALIUS_ERROR_ARGUMENT,
               "detector is NULL");
  expect_error(vesalius_detector_detect(quick_detector(), &given_, &camera_, nullptr), VESALIUS_ERROR_ARGUMENT,
               "people is NULL");
  expect_error(vesalius_tracker_update(nullptr, &given_, &camera_, &people), VESALIUS_ERROR_ARGUMENT,
               "tracker is NULL");
  expect_error(vesalius_tracker_update(tracker_.get(), &given_, &camera_, nullptr), VESALIUS_ERROR_ARGUMENT,
               "people is NULL");
  vesalius_tracker* tracker = nullptr;
  expect_error(vesalius_tracker_create(nullptr, &tracker), VESALIUS_ERROR_ARGUMENT, "detector is NULL");
  expect_error(vesalius_tracker_create(quick_detector(), nullptr), VESALIUS_ERROR_ARGUMENT, "tracker is NULL");
  expect_error(vesalius_options_create(nullptr), VESALIUS_ERROR_ARGUMENT, "options is NULL");
  expect_error(vesalius_options_set(nullptr, "refine.min-score", "1"), VESALIUS_ERROR_ARGUMENT, "options is NULL");
  expect_error(vesalius_options_load(nullptr, "x"), VESALIUS_ERROR_ARGUMENT, "options is NULL");
  EXPECT_EQ(vesalius_options_count(nullptr), -1);
  EXPECT_EQ(vesalius_people_count(nullptr), -1);
  EXPECT_EQ(vesalius_detector_part_count(nullptr), -1);
  EXPECT_EQ(vesalius_detector_part_name(nullptr, 0), nullptr);
  EXPECT_EQ(vesalius_detector_joint_set_count(nullptr), -1);
  EXPECT_EQ(vesalius_detector_joint_set_name(nullptr, 0), nullptr);
  EXPECT_EQ(vesalius_detector_joint_count(nullptr, nullptr), -1);
  EXPECT_EQ(vesalius_detector_joint_name(nullptr, nullptr, 0), nullptr);
}

TEST_F(CErrors, OfNamesThatAreNotThere) {
  for (const int index : {-1, 1000, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    EXPECT_EQ(vesalius_detector_part_name(quick_detector(), index), nullptr);
    EXPECT_THAT(vesalius_last_error(), HasSubstr("part " + std::to_string(index) + " is not there"));
    EXPECT_EQ(vesalius_detector_joint_set_name(quick_detector(), index), nullptr);
    EXPECT_EQ(vesalius_detector_joint_name(quick_detector(), nullptr, index), nullptr);
  }
  EXPECT_EQ(vesalius_detector_joint_count(quick_detector(), "body25"), -1);
  EXPECT_THAT(vesalius_last_error(), HasSubstr("joint set \"body25\" is not of this body, expected one of: "));
  EXPECT_EQ(vesalius_detector_joint_name(quick_detector(), "", 0), nullptr);
}

TEST_F(CErrors, OfOptions) {
  const Options options = make_options();
  const auto set = [&](const char* name, const char* value, const std::string& why) {
    expect_error(vesalius_options_set(options.get(), name, value), VESALIUS_ERROR_ARGUMENT, why);
  };
  set(nullptr, "1", "name is NULL");
  set("refine.min-score", nullptr, "value is NULL");
  set("refine.min-scores", "1", "did you mean \"refine.min-score\"?");
  set("refine.min-score", "7", "option refine.min-score is 7, expected 0 to 1");
  set("refine.min-score", "high", "option refine.min-score: found \"high\", expected a number");
  set("refine.max-candidates", "1.5", "expected a whole number");
  set("refine.second-pass", "1", "expected true or false");
  set("refine.min-score", "0.9\nrefine.max-candidates = 1", "expected a number");
  EXPECT_EQ(value_of(options, "refine.min-score"), value_of(make_options(), "refine.min-score"));
  expect_error(vesalius_options_load(options.get(), nullptr), VESALIUS_ERROR_ARGUMENT, "path is NULL");
  expect_error(vesalius_options_load(options.get(), "/none.toml"), VESALIUS_ERROR_INPUT, "/none.toml");
  vesalius_option option{};
  expect_error(vesalius_options_get(options.get(), 0, &option), VESALIUS_ERROR_ARGUMENT, "option: struct_size is 0");
  option.struct_size = sizeof option;
  expect_error(vesalius_options_get(options.get(), -1, &option), VESALIUS_ERROR_ARGUMENT, "option -1 is not there");
  expect_error(vesalius_options_get(options.get(), 0, nullptr), VESALIUS_ERROR_ARGUMENT, "option is NULL");
}

TEST_F(CErrors, OfDetectors) {
  const auto refused = [&](const char* model, int threads, const char* device, vesalius_status status,
                           const std::string& why) {
    auto* detector = reinterpret_cast<vesalius_detector*>(this);
    expect_error(vesalius_detector_create(model, nullptr, threads, device, &detector), status, why);
    EXPECT_EQ(detector, nullptr);
  };
  const std::string small = kData + "models/capsule.forest", readme = kData + "models/README.md";
  refused("/none.forest", 0, nullptr, VESALIUS_ERROR_INPUT, "/none.forest");
  refused(readme.c_str(), 0, nullptr, VESALIUS_ERROR_INPUT, "README.md");
  refused("", 0, nullptr, VESALIUS_ERROR_INPUT, "");
  refused(small.c_str(), -1, nullptr, VESALIUS_ERROR_ARGUMENT, "threads is -1, expected 0 (all) to 1024");
  refused(small.c_str(), 1025, nullptr, VESALIUS_ERROR_ARGUMENT, "threads is 1025");
  refused(small.c_str(), 1, "abacus", VESALIUS_ERROR_ARGUMENT, "abacus");
  refused(small.c_str(), 1, "cuda:999", VESALIUS_ERROR_DEVICE, "");
  expect_error(vesalius_detector_create(small.c_str(), nullptr, 0, nullptr, nullptr), VESALIUS_ERROR_ARGUMENT,
               "detector is NULL");
}

TEST_F(CErrors, OfPeople) {
  const CPeople people = detect(usual_detector(), given_, camera_);
  const int found = vesalius_people_count(people.get());
  ASSERT_GT(found, 0);
  vesalius_person person = person_at(people, 0);
  for (const int index : {-1, found, std::numeric_limits<int>::max()}) {
    const std::string why =
        "person " + std::to_string(index) + " is not there, expected one of " + std::to_string(found);
    int32_t count = 7;
    expect_error(vesalius_people_get(people.get(), index, &person), VESALIUS_ERROR_ARGUMENT, why);
    expect_error(vesalius_people_joints(people.get(), index, nullptr, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT,
                 why);
    expect_error(vesalius_people_parts(people.get(), index, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, why);
    expect_error(vesalius_people_joints_unseen(people.get(), index, nullptr, nullptr, 0, &count),
                 VESALIUS_ERROR_ARGUMENT, why);
    expect_error(vesalius_people_parts_unseen(people.get(), index, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, why);
    expect_error(vesalius_people_bones(people.get(), index, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, why);
    expect_error(vesalius_people_rotations(people.get(), index, nullptr, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT,
                 why);
    expect_error(vesalius_people_mask(people.get(), index, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, why);
    expect_error(vesalius_people_labels(people.get(), index, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, why);
    EXPECT_EQ(count, 7);
  }
  int32_t count = 0;
  const vesalius_people* none = nullptr;
  expect_error(vesalius_people_get(none, 0, &person), VESALIUS_ERROR_ARGUMENT, "people is NULL");
  expect_error(vesalius_people_joints(none, 0, nullptr, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, "people is NULL");
  expect_error(vesalius_people_mask(none, 0, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, "people is NULL");
  expect_error(vesalius_people_labels(none, 0, nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT, "people is NULL");
  expect_error(vesalius_people_get(people.get(), 0, nullptr), VESALIUS_ERROR_ARGUMENT, "person is NULL");
  person.struct_size = 4;
  expect_error(vesalius_people_get(people.get(), 0, &person), VESALIUS_ERROR_ARGUMENT, "person: struct_size is 4");
  expect_error(vesalius_people_joints(people.get(), 0, "feet", nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT,
               "joint set \"feet\"");
  expect_error(vesalius_people_joints_unseen(people.get(), 0, "feet", nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT,
               "joint set \"feet\"");
  expect_error(vesalius_people_rotations(people.get(), 0, "feet", nullptr, 0, &count), VESALIUS_ERROR_ARGUMENT,
               "joint set \"feet\"");
  EXPECT_EQ(vesalius_people_bones(people.get(), 0, nullptr, 0, &count), VESALIUS_OK);
  EXPECT_EQ(count, 0) << "a detector fits no bodies";
}

TEST_F(CErrors, OfBuffers) {
  const CPeople people = detect(usual_detector(), given_, camera_);
  const int pixels = camera_.width * camera_.height;
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(pixels), 77);
  int32_t count = 0;
  expect_error(vesalius_people_mask(people.get(), 0, mask.data(), pixels - 1, &count), VESALIUS_ERROR_CAPACITY,
               "mask: capacity is " + std::to_string(pixels - 1) + ", expected " + std::to_string(pixels));
  EXPECT_EQ(count, pixels);
  EXPECT_EQ(std::count(mask.begin(), mask.end(), 77), pixels) << "nothing is written";
  expect_error(vesalius_people_labels(people.get(), 0, mask.data(), -1, &count), VESALIUS_ERROR_ARGUMENT,
               "capacity is -1");
  expect_error(vesalius_people_mask(people.get(), 0, nullptr, pixels, &count), VESALIUS_ERROR_ARGUMENT, "mask is NULL");
  expect_error(vesalius_people_mask(people.get(), 0, nullptr, 0, nullptr), VESALIUS_ERROR_ARGUMENT,
               "mask and count are NULL");
  std::vector<vesalius_joint> joints(32);
  expect_error(vesalius_people_joints(people.get(), 0, nullptr, joints.data(), 31, nullptr), VESALIUS_ERROR_CAPACITY,
               "joints: capacity is 31, expected 32");
  EXPECT_EQ(vesalius_people_joints(people.get(), 0, nullptr, joints.data(), 32, nullptr), VESALIUS_OK);
  vesalius_part part{};
  expect_error(vesalius_people_parts(people.get(), 0, &part, 1, &count), VESALIUS_ERROR_CAPACITY,
               "parts: capacity is 1");
}

}  // namespace
}  // namespace vesalius
