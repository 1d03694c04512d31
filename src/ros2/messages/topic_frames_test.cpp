#include "ros2/messages/topic_frames.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "ros2/messages/test_people.h"
#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;

class TopicFramesTest : public testing::Test {
 protected:
  static Frame frame(std::uint16_t depth_mm = 2000) {
    Frame made;
    made.camera = {8, 6, 10.F, 10.F, 3.5F, 2.5F};
    made.depth = DepthImage(8, 6, depth_mm);
    made.colour = ColourImage(8, 6, Rgb{1, 2, 3});
    return made;
  }
  static std::string depth(std::int64_t time_ns, const std::string& place = "camera") {
    return depth_message(frame().depth, time_ns, place);
  }
  static std::string colour(std::int64_t time_ns, const std::string& place = "camera") {
    return colour_message(frame().colour, time_ns, place);
  }
  static std::string info() { return calibration_message(frame().camera, 0, "camera"); }
  static CameraTopics topics(bool with_colour = true) {
    return {"/c/depth/image", "/c/depth/camera_info", with_colour ? "/c/color/image" : ""};
  }
};

TEST_F(TopicFramesTest, PutDepthAndColourTogether) {
  TopicFrames frames(topics());
  frames.take_calibration(info());
  frames.take_depth(depth(1000 * kMs + 7), 10.0);
  EXPECT_FALSE(frames.next(10.01)) << "its colour may still come";
  frames.take_colour(colour(1010 * kMs));
  const auto made = frames.next(10.02);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->stamp.time_ns, 1000 * kMs + 7);
  EXPECT_EQ(made->stamp.frame, "camera");
  EXPECT_EQ(made->frame.name, "1.000000007");
  EXPECT_EQ(made->frame.arrived_s, 10.0);
  EXPECT_EQ(made->frame.camera, frame().camera);
  EXPECT_EQ(made->frame.depth, frame().depth);
  EXPECT_EQ(made->frame.colour, frame().colour);
  EXPECT_FALSE(frames.next(10.03));
}

TEST_F(TopicFramesTest, TakeTheColourThatIsNearest) {
  TopicFrames frames(topics());
  frames.take_calibration(info());
  ColourImage other = frame().colour;
  other(0, 0) = {9, 9, 9};
  frames.take_colour(colour_message(other, 980 * kMs, "camera"));
  frames.take_colour(colour(1005 * kMs));
  frames.take_depth(depth(1000 * kMs), 10.0);
  EXPECT_EQ(frames.next(10.0)->frame.colour(0, 0), (Rgb{1, 2, 3}));
  frames.take_depth(depth(990 * kMs), 10.0);
  EXPECT_EQ(frames.next(10.0)->frame.colour(0, 0), (Rgb{9, 9, 9}));
  frames.take_depth(depth(1056 * kMs), 10.0);
  EXPECT_TRUE(frames.next(11.0)->frame.colour.empty()) << "51 ms away";
}

TEST_F(TopicFramesTest, GoWithoutColourThatDoesNotCome) {
  TopicFrames frames(topics());
  frames.take_calibration(info());
  frames.take_depth(depth(1000 * kMs), 10.0);
  EXPECT_FALSE(frames.next(10.09));
  ASSERT_TRUE(frames.next(10.11));
  TopicFrames alone(topics(false));
  alone.take_calibration(info());
  alone.take_depth(depth(1000 * kMs), 10.0);
  EXPECT_TRUE(alone.next(10.0));
}

TEST_F(TopicFramesTest, NeedACalibration) {
  TopicFrames frames(topics(false));
  frames.take_depth(depth(1), 10.0);
  EXPECT_FALSE(frames.next(20.0));
  EXPECT_TRUE(frames.lacks_calibration());
  frames.take_calibration(info());
  EXPECT_TRUE(frames.next(20.0));
}

TEST_F(TopicFramesTest, ReadMetres) {
  TopicFrames frames(topics(false));
  frames.take_calibration(info());
  std::vector<float> metres(48, 1.2345F);
  metres[0] = std::nanf("");
  metres[1] = -1.F;
  metres[2] = 70.F;
  PictureMessage picture;
  picture.frame = "camera";
  picture.width = 8;
  picture.height = 6;
  picture.encoding = "32FC1";
  picture.row_bytes = 32;
  picture.data = {reinterpret_cast<const char*>(metres.data()), metres.size() * 4};
  frames.take_depth(picture_message(picture), 10.0);
  const auto made = frames.next(10.0);
  EXPECT_EQ(made->frame.depth(0, 0), 0);
  EXPECT_EQ(made->frame.depth(1, 0), 0);
  EXPECT_EQ(made->frame.depth(2, 0), 0);
  EXPECT_EQ(made->frame.depth(3, 0), 1235);
}

TEST_F(TopicFramesTest, SayOnceThatColourIsNotRegistered) {
  TopicFrames frames(topics());
  frames.take_calibration(info());
  for (const std::int64_t t : {1000, 1033}) {
    frames.take_colour(colour(t * kMs, "colour_camera"));
    frames.take_depth(depth(t * kMs), 10.0);
    EXPECT_TRUE(frames.next(10.0)->frame.colour.empty());
  }
  EXPECT_THAT(frames.take_notes(), ElementsAre(HasSubstr("not registered")));
  EXPECT_THAT(frames.take_notes(), IsEmpty());
}

TEST_F(TopicFramesTest, UndoLenses) {
  const Frame seen = frame();
  Calibration calibration;
  calibration.width = 8;
  calibration.height = 6;
  calibration.model = "plumb_bob";
  calibration.distortion = {1.5, 0, 0, 0, 0};
  calibration.matrix = {10, 0, 3.5, 0, 10, 2.5, 0, 0, 1};
  TopicFrames frames(topics(false));
  frames.take_calibration(calibration_message(calibration, 0));
  DepthImage depth(8, 6);
  for (int u = 0; u < 8; ++u) {
    for (int v = 0; v < 6; ++v) depth(u, v) = static_cast<std::uint16_t>(1000 + 10 * u + v);
  }
  frames.take_depth(depth_message(depth, 1, "camera"), 10.0);
  const auto made = frames.next(10.0);
  ASSERT_TRUE(made);
  const Rectification expected({{8, 6, 10.F, 10.F, 3.5F, 2.5F}, *make_lens("plumb_bob", calibration.distortion)},
                               {8, 6, 10.F, 10.F, 3.5F, 2.5F});
  EXPECT_EQ(made->frame.depth, expected.depth(depth));
  EXPECT_NE(made->frame.depth, depth);
}

TEST_F(TopicFramesTest, RefuseCalibrationsThatAreNone) {
  TopicFrames frames(topics(false));
  Calibration calibration;
  calibration.width = 8;
  calibration.height = 6;
  calibration.model = "plumb_bob";
  calibration.matrix = {NAN, 0, 3.5, 0, 10, 2.5, 0, 0, 1};
  try {
    frames.take_calibration(calibration_message(calibration, 0));
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("/c/depth/camera_info: "));
  }
  calibration.matrix = {};
  EXPECT_THROW(frames.take_calibration(calibration_message(calibration, 0)), Error);
  EXPECT_THROW(frames.take_calibration(""), Error);
  EXPECT_THROW(frames.take_calibration(info().substr(0, 100)), Error);
  frames.take_depth(depth(1), 10.0);
  EXPECT_FALSE(frames.next(20.0));
}

TEST_F(TopicFramesTest, KeepNothingForACalibrationOfAnEnormousCamera) {
  Calibration calibration;
  calibration.width = calibration.height = 60'000'000;
  calibration.model = "plumb_bob";
  calibration.distortion = {0.1, 0, 0, 0, 0};
  calibration.matrix = {10, 0, 3.5, 0, 10, 2.5, 0, 0, 1};
  TopicFrames frames(topics(false));
  frames.take_calibration(calibration_message(calibration, 0));
  frames.take_depth(depth(1), 10.0);
  EXPECT_THROW(frames.next(10.0), Error);
}

TEST_F(TopicFramesTest, RefusePicturesThatAreNoneAndGoOn) {
  TopicFrames frames(topics());
  frames.take_calibration(info());
  EXPECT_THROW(frames.take_depth(colour(1), 10.0), Error) << "is colour";
  EXPECT_THROW(frames.take_depth("", 10.0), Error);
  EXPECT_THROW(frames.take_depth(depth(1).substr(0, 60), 10.0), Error);
  frames.take_depth(depth_message(DepthImage(4, 6), 1, "camera"), 10.0);
  EXPECT_THROW(frames.next(20.0), Error) << "another size than the calibration's";
  frames.take_depth(depth(2), 10.0);
  EXPECT_TRUE(frames.next(20.0));
}

TEST_F(TopicFramesTest, NoteDepthOfAnotherUnitAndTakeIt) {
  Camera camera{160, 120, 130.F, 130.F, 79.5F, 59.5F};
  DepthImage room(160, 120), tenths(160, 120);
  for (int v = 0; v < room.height(); ++v) {
    for (int u = 0; u < room.width(); ++u) room(u, v) = static_cast<std::uint16_t>(2000 + 10 * u + (u * v) % 7);
  }
  std::ranges::transform(room, tenths.begin(), [](std::uint16_t mm) { return static_cast<std::uint16_t>(10 * mm); });
  const auto notes_of = [&](const DepthImage& stored, const SourceOptions& options, int empty = 0) {
    TopicFrames frames(topics(false), options);
    frames.take_calibration(calibration_message(camera, 0, "camera"));
    for (int i = 0; i < empty; ++i) {
      frames.take_depth(depth_message(DepthImage(160, 120), i, "camera"), 10.0);
      frames.next(20.0);
    }
    frames.take_depth(depth_message(stored, 100, "camera"), 10.0);
    EXPECT_EQ(frames.next(20.0)->frame.depth, options.depth_scale ? room : stored);
    return frames.take_notes();
  };
  SourceOptions in_tenths;
  in_tenths.depth_scale = 10000.F;
  EXPECT_THAT(notes_of(room, {}), IsEmpty());
  EXPECT_THAT(notes_of(tenths, {}),
              ElementsAre(AllOf(HasSubstr("/c/depth/image: "), HasSubstr("--depth-scale 10000"))));
  EXPECT_THAT(notes_of(tenths, in_tenths), IsEmpty());
  EXPECT_THAT(notes_of(tenths, {}, 3), ElementsAre(HasSubstr("--depth-scale 10000"))) << "a camera begins with nothing";
  EXPECT_THAT(notes_of(room, {}, 5), ElementsAre(HasSubstr("hardly any depth")));
}

TEST(ChooseTopics, PrefersDepthOnTheGridOfColour) {
  const std::vector<std::string> published = {"/camera/depth/image_rect_raw", "/camera/color/image_raw",
                                              "/camera/aligned_depth_to_color/image_raw", "/other/depth/image_raw"};
  const auto chosen = choose_topics("/camera", {}, published);
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->depth, "/camera/aligned_depth_to_color/image_raw");
  EXPECT_EQ(chosen->camera_info, "/camera/aligned_depth_to_color/camera_info");
  EXPECT_EQ(chosen->colour, "/camera/color/image_raw");
  EXPECT_EQ(choose_topics("/other", {}, published)->colour, "");
  EXPECT_FALSE(choose_topics("/cam", {}, published));
}

TEST(ChooseTopics, TakesWhatTheUserNames) {
  const auto chosen = choose_topics("/camera", {"/a/depth/compressedDepth", "", ""}, {"/camera/depth/image_raw"});
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->depth, "/a/depth/compressedDepth");
  EXPECT_EQ(chosen->camera_info, "/a/camera_info");
  EXPECT_EQ(chosen->colour, "");
  EXPECT_STREQ(picture_type(chosen->depth), "sensor_msgs/CompressedImage");
  EXPECT_STREQ(picture_type("/a/depth"), "sensor_msgs/Image");
  EXPECT_EQ(choose_topics("/", {}, {"/depth/image_raw"})->depth, "/depth/image_raw");
}

}  // namespace
}  // namespace vesalius::ros2
