#include "io/recordings/foxglove_messages.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/transform_messages.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::HasSubstr;

const RecordedTopic kDepth{"/depth", "foxglove.RawImage", MessageLayout::json, 1};
constexpr const char* kRawImage = R"({"timestamp": {"sec": 5, "nsec": 7}, "frame_id": "cam", "width": 2, "height": 1,
  "encoding": "16UC1", "step": 4, "data": ")";

TEST(FoxgloveMessages, OfJsonHaveTheirPicturesInBase64) {
  const PictureMessage picture = parse_picture(kDepth, std::string(kRawImage) + "6AP/AA==\"}", "a.mcap");
  EXPECT_EQ(picture.time_ns, 5 * kNanoseconds + 7);
  EXPECT_EQ(picture.frame, "cam");
  const DepthImage depth = depth_of(picture, {}, "a.mcap");
  EXPECT_EQ(depth(0, 0), 1000);
  EXPECT_EQ(depth(1, 0), 255);
}

TEST(FoxgloveMessages, ThatAreNoneAreRefused) {
  EXPECT_THAT(error_of([] { parse_picture(kDepth, std::string(kRawImage) + "!\"}", "a.mcap"); }), HasSubstr("base64"));
  EXPECT_THAT(error_of([] { parse_picture(kDepth, "[1, 2]", "a.mcap"); }), HasSubstr("no JSON object"));
  EXPECT_THAT(error_of([] { parse_picture(kDepth, std::string(1 << 20, '['), "a.mcap"); }), HasSubstr("values"));
}

TEST(FoxgloveMessages, LackWhatTheyLack) {
  const PictureMessage picture = parse_picture(kDepth, R"({"timestamp": "now", "width": -3, "data": 5})", "a.mcap");
  EXPECT_EQ(picture.time_ns, 0);
  EXPECT_EQ(picture.width, 0);
  EXPECT_EQ(picture.data, "");
}

TEST(FoxgloveMessages, OfCalibrationsAreTheSameInJsonAndRos) {
  CdrWriter cdr;
  cdr.u32(1);
  cdr.u32(2);
  cdr.text("cam");
  cdr.u32(640);
  cdr.u32(480);
  cdr.text("plumb_bob");
  cdr.u32(1);
  cdr.real64(0.5);
  for (int i = 0; i < 30; ++i) cdr.real64(i);
  const Calibration ros =
      parse_calibration({"/c", "foxglove_msgs/CameraCalibration", MessageLayout::cdr, 1}, cdr.message(), "a.mcap");
  const Calibration json = parse_calibration({"/c", "foxglove.CameraCalibration", MessageLayout::json, 1},
                                             R"({"frame_id": "cam", "width": 640, "height": 480, "D": [0.5],
      "distortion_model": "plumb_bob", "K": [0, 1, 2, 3, 4, 5, 6, 7, 8]})",
                                             "a.mcap");
  EXPECT_EQ(ros.frame, json.frame);
  EXPECT_EQ(ros.width, json.width);
  EXPECT_EQ(ros.model, json.model);
  EXPECT_EQ(ros.distortion, json.distortion);
  EXPECT_EQ(ros.matrix, json.matrix);
}

TEST(FoxgloveMessages, OfTransformsComeAlone) {
  const auto found = parse_transforms({"/tf", "foxglove.FrameTransforms", MessageLayout::json, 1},
                                      R"({"transforms": [{"parent_frame_id": "a", "child_frame_id": "b",
      "translation": {"x": 1, "y": 2, "z": 3}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}}]})",
                                      "a.mcap");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].child, "b");
  EXPECT_EQ(found[0].parent_from_child.translation(), Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace vesalius
