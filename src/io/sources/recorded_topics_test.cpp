#include "io/sources/recorded_topics.h"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "io/recordings/message_fields.h"
#include "io/sources/test_bag.h"
#include "io/sources/test_messages.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::Messages;
using test::random_frame;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::int64_t kMs = 1'000'000;
constexpr const char* kImage = "sensor_msgs/msg/Image";
constexpr const char* kCompressed = "sensor_msgs/msg/CompressedImage";

std::string packed(const std::string& format, const std::string& data, const std::string& frame = "depth_frame") {
  PictureMessage picture;
  picture.frame = frame;
  picture.compressed = true;
  picture.encoding = format;
  picture.data = data;
  return picture_message(picture);
}

template <class T>
std::string raw(const std::string& encoding, const Image<T>& image, int width = 0) {
  PictureMessage picture;
  picture.frame = "depth_frame";
  picture.width = width == 0 ? image.width() : width;
  picture.height = image.height();
  picture.encoding = encoding;
  picture.row_bytes = static_cast<std::uint32_t>(image.width() * int(sizeof(T)));
  picture.data = {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(T)};
  return picture_message(picture);
}

SourceItem item_of(const FrameSource& source, const std::string& topic) {
  for (const SourceItem& item : source.contents()) {
    if (item.name == topic) return item;
  }
  ADD_FAILURE() << topic << " is not listed";
  return {};
}

/// A recording of depth with a calibration, and what a test adds.
class RecordedTopics : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const SourceOptions& options = {}) {
    out_.close();
    return open_source(folder_ / "a.mcap", options);
  }

  test::TemporaryFolder folder_;
  Frame a_ = random_frame("a", 1, 40, 30);
  Messages out_{folder_ / "a.mcap"};
};

TEST(TopicName, SaysWhatPicturesAreOf) {
  for (const char* depth :
       {"/camera/depth/image_rect_raw", "/camera/aligned_depth_to_color/image_raw", "/depth_to_rgb/image_raw",
        "/kinect2/sd/image_depth", "/ir_camera/depth/image", "/camera/color/depth_image",
        "/camera/depth/image/compressedDepth", "/cam/sensor_3/frameType_3", "/device_0/sensor_0/Depth_0/image/data",
        "/camera/depth_registered/points"}) {
    EXPECT_EQ(name_says(depth), TopicName::depth) << depth;
  }
  for (const char* other :
       {"/kinect2/sd/image_ir", "/camera/infra1/image_rect_raw", "/camera/ir/image/compressedDepth",
        "/device_0/sensor_0/Infrared_1/image/data", "/camera/depth/confidence", "/thermal/image_raw", "/flir/image",
        "/zed/disparity", "/people/body_index", "/cam/sensor_6/frameType_6"}) {
    EXPECT_EQ(name_says(other), TopicName::other) << other;
  }
  for (const char* colour : {"/camera/color/image_raw", "/camera/rgb/image_raw/compressed", "/cam/sensor_2/frameType_2",
                             "/left/image_mono", "/kinect2/qhd/image_color_rect"}) {
    EXPECT_EQ(name_says(colour), TopicName::colour) << colour;
  }
  for (const char* nothing : {"/oak/stereo/image_raw", "/rgbd/image", "/circle/image", "/monocular/image", "/"}) {
    EXPECT_EQ(name_says(nothing), TopicName::nothing) << nothing;
  }
}

TEST_F(RecordedTopics, DepthIsTheOneThatIsCalledSo) {
  out_.camera("/kinect2/sd/camera_info", a_.camera);
  const Frame infrared = random_frame("b", 2, 40, 30), plain = random_frame("c", 3, 40, 30);
  out_.depth("/kinect2/sd/image_ir", 0, infrared);
  out_.depth("/kinect2/sd/image", 0, plain);
  out_.depth("/kinect2/sd/image_depth", 0, a_);
  const auto source = open();
  EXPECT_EQ(source->next()->depth, a_.depth);
  EXPECT_THAT(source->notes(), ElementsAre(AllOf(HasSubstr("depth of /kinect2/sd/image_depth"),
                                                 HasSubstr("there is also /kinect2/sd/image"), Not(HasSubstr("_ir")))));
  EXPECT_EQ(item_of(*source, "/kinect2/sd/image_depth").use, "depth");
  EXPECT_EQ(item_of(*source, "/kinect2/sd/image_depth").holds, "sensor_msgs/Image 16UC1 40x30");
  EXPECT_EQ(item_of(*source, "/kinect2/sd/image_depth").count, 1);
  EXPECT_THAT(item_of(*source, "/kinect2/sd/image_ir").why, HasSubstr("--depth-topic"));
  SourceOptions named;
  named.depth_topic = "/kinect2/sd/image_ir";
  EXPECT_EQ(open_source(folder_ / "a.mcap", named)->next()->depth, infrared.depth);
}

TEST_F(RecordedTopics, WholeNumbersOf32BitsComeLast) {
  out_.camera("/camera/camera_info", a_.camera);
  Image<std::int32_t> labels(40, 30, 3);
  out_.put("/camera/instances", kImage, 0, raw("32SC1", labels));
  out_.put("/camera/z", kImage, 0, raw("32FC1", Image<float>(40, 30, 2.F)));
  EXPECT_EQ(open()->next()->depth(0, 0), 2000);
}

TEST_F(RecordedTopics, OfCalibrationsAsNearByNameThatOfDepthIsTaken) {
  Camera other = a_.camera;
  other.fx = 99.F;
  out_.camera("/cam/info_color", other);
  out_.camera("/cam/info_depth", a_.camera);
  out_.depth("/cam/depth", 0, a_);
  EXPECT_EQ(open()->next()->camera.fx, a_.camera.fx);
}

TEST_F(RecordedTopics, TheLargestNumberIsNoReading) {
  out_.camera("/depth/camera_info", a_.camera);
  a_.depth(3, 2) = 65535;
  a_.depth(4, 2) = 65534;
  out_.depth("/depth/image", 0, a_);
  const Frame frame = *open()->next();
  EXPECT_EQ(frame.depth(3, 2), 0);
  EXPECT_EQ(frame.depth(4, 2), 65534);
}

TEST_F(RecordedTopics, InfraredAloneIsNoDepthAndTheErrorListsIt) {
  out_.camera("/camera/ir/camera_info", a_.camera);
  out_.depth("/camera/ir/image", 0, a_);
  out_.put("/chatter", "std_msgs/msg/String", 0, std::string(8, '\0'));
  const std::string error = error_of([&] { open(); });
  EXPECT_THAT(error, AllOf(HasSubstr("no depth, expected a topic"), HasSubstr("/camera/ir/image "),
                           HasSubstr("16UC1 40x30"), HasSubstr("--depth-topic takes it"), HasSubstr("/chatter")));
}

TEST_F(RecordedTopics, DepthMayBeginAfterAnyNumberOfMessages) {
  for (int i = 0; i < 12'000; ++i) out_.put("/joint_states", "std_msgs/msg/String", i * kMs, "x");
  out_.put("/depth/image", kImage, 12'000 * kMs, depth_message(a_.depth, 12'000 * kMs, "depth_frame"));
  out_.put("/depth/camera_info", "sensor_msgs/msg/CameraInfo", 12'001 * kMs,
           calibration_message(a_.camera, 0, "depth_frame"));
  EXPECT_EQ(open()->next()->depth, a_.depth);
}

TEST_F(RecordedTopics, MessagesWithoutPixelsBeforeDepthAreNamedAndLeftOut) {
  out_.put("/depth/image", kImage, 0, depth_message({}, 0, "depth_frame"));
  out_.put("/depth/image", kImage, kMs, depth_message(a_.depth, kMs, "depth_frame").substr(0, 100));
  out_.camera("/depth/camera_info", a_.camera);
  out_.depth("/depth/image", 2 * kMs, a_);
  out_.depth("/depth/image", 3 * kMs, a_);
  const auto source = open();
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("2 messages of /depth/image before the first frame left out")));
  EXPECT_EQ(source->size(), 2);
  EXPECT_EQ(source->next()->name, "0.002000000");
  EXPECT_EQ(source->next()->name, "0.003000000");
  EXPECT_FALSE(source->next());
}

TEST_F(RecordedTopics, AFirstPictureOfASizeOfItsOwnIsLeftOut) {
  out_.camera("/depth/camera_info", a_.camera);
  out_.depth("/depth/image", 0, random_frame("b", 2, 20, 15));
  for (const std::int64_t ms : {1, 2, 3}) out_.depth("/depth/image", ms * kMs, a_);
  const auto source = open();
  EXPECT_EQ(source->size(), 3);
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("1 message of /depth/image before the first frame left out")));
  for (const char* name : {"0.001000000", "0.002000000", "0.003000000"}) EXPECT_EQ(source->next()->name, name);
  source->seek(0.0);
  EXPECT_EQ(source->next()->name, "0.001000000");
}

TEST_F(RecordedTopics, PicturesThatAreNotWantedAreNotDecoded) {
  for (int i = 0; i < 300; ++i) {
    ByteWriter head;
    for (const std::uint32_t word : {0U, 0U, 0U, 8192U, 8192U}) head.number(word);
    out_.put("/d" + std::to_string(i) + "/depth/compressedDepth", kCompressed, 0,
             packed("16UC1; compressedDepth rvl", head.bytes() + std::string(4, '\0')));
  }
  const std::string error = error_of([&] { open(); });
  EXPECT_THAT(error, AllOf(HasSubstr("no intrinsics"), HasSubstr("8192x8192"), HasSubstr("and 240 topics more")));
}

TEST_F(RecordedTopics, APngOf16BitsIsDepth) {
  out_.camera("/depth/camera_info", a_.camera);
  out_.put("/depth/image/compressed", kCompressed, 0, packed("16UC1; png compressed ", encode_png(a_.depth)));
  EXPECT_EQ(open()->next()->depth, a_.depth);
}

TEST_F(RecordedTopics, AJpegOfDepthIsNoColour) {
  out_.camera("/depth/camera_info", a_.camera);
  out_.depth("/depth/image", 0, a_);
  out_.put("/depth/image/compressed", kCompressed, 0, packed("16UC1; jpeg compressed ", encode_jpeg(a_.colour, 90)));
  const auto source = open();
  EXPECT_TRUE(source->next()->colour.empty());
  EXPECT_THAT(source->notes(), ElementsAre(AllOf(HasSubstr("no colour, since /depth/image/compressed"),
                                                 HasSubstr("16UC1; jpeg"), HasSubstr("no distances"))));
}

TEST_F(RecordedTopics, EncodingsOfDepthAreRead) {
  Image<std::int16_t> with_sign(40, 30);
  Image<std::int32_t> wide(40, 30);
  Image<double> metres(40, 30);
  DepthImage positive = a_.depth;
  for (std::size_t i = 0; i < positive.size(); ++i) {
    with_sign[i] = static_cast<std::int16_t>(i % 7 == 0 ? -5 : positive[i]);
    wide[i] = i % 7 == 0 ? i % 2 == 0 ? -5 : 70000 : positive[i];
    metres[i] = double(positive[i]) / 1e3;
    if (i % 7 == 0) positive[i] = 0;
  }
  const std::vector<std::tuple<const char*, std::string, DepthImage>> all{
      {"z16", raw("z16", a_.depth), a_.depth},      {"Z16", raw("Z16", a_.depth), a_.depth},
      {"16SC1", raw("16SC1", with_sign), positive}, {"32SC1", raw("32SC1", wide), positive},
      {"16uc1", raw("16uc1", a_.depth), a_.depth},  {"TYPE", raw("TYPE_16UC1", a_.depth), a_.depth},
      {"64FC1", raw("64FC1", metres), a_.depth}};
  for (const auto& [name, message, depth] : all) {
    const std::string path = folder_ / (std::string(name) + ".mcap");
    Messages out(path);
    out.camera("/camera/camera_info", a_.camera);
    out.put("/camera/image", kImage, 0, message);
    out.close();
    EXPECT_EQ(open_source(path)->next()->depth, depth) << name;
  }
}

TEST_F(RecordedTopics, RowsWhoseLengthIsLeftOutFollowEachOther) {
  PictureMessage picture;
  picture.frame = "depth_frame";
  picture.width = a_.depth.width();
  picture.height = a_.depth.height();
  picture.encoding = "16UC1";
  picture.data = {reinterpret_cast<const char*>(a_.depth.data()), a_.depth.size() * sizeof(std::uint16_t)};
  out_.camera("/camera/depth/camera_info", a_.camera);
  out_.put("/camera/depth/image", kImage, 0, picture_message(picture));
  EXPECT_EQ(open()->next()->depth, a_.depth);
}

/// Writes a stereo_msgs/DisparityImage as CDR.
std::string disparity_message(const Image<float>& disparity, float focal, float baseline) {
  CdrWriter out;
  out.header(0, "depth_frame");
  out.header(0, "depth_frame");
  out.u32(static_cast<std::uint32_t>(disparity.height()));
  out.u32(static_cast<std::uint32_t>(disparity.width()));
  out.text("32FC1");
  out.u8(0);
  out.u32(static_cast<std::uint32_t>(disparity.width()) * 4);
  out.bytes({reinterpret_cast<const char*>(disparity.data()), disparity.size() * sizeof(float)});
  out.real32(focal);
  out.real32(baseline);
  for (int i = 0; i < 4; ++i) out.u32(0);
  out.u8(0);
  for (int i = 0; i < 3; ++i) out.real32(0.F);
  return out.message();
}

TEST_F(RecordedTopics, DisparitiesBecomeDepth) {
  Image<float> disparity(40, 30, -1.F);
  disparity(3, 4) = 10.F;
  out_.camera("/stereo/camera_info", a_.camera);
  out_.put("/stereo/disparity", "stereo_msgs/msg/DisparityImage", 0, disparity_message(disparity, 400.F, 0.05F));
  const Frame frame = *open()->next();
  EXPECT_EQ(frame.depth(3, 4), 2000);
  EXPECT_EQ(std::ranges::count(frame.depth, 0), 40 * 30 - 1);
}

/// Writes a sensor_msgs/PointCloud2 of rgb, x, y, z as CDR.
std::string points_message(const Frame& frame, bool in_rows) {
  CdrWriter out;
  out.header(0, "depth_frame");
  out.u32(in_rows ? static_cast<std::uint32_t>(frame.depth.height()) : 1);
  out.u32(static_cast<std::uint32_t>(in_rows ? frame.depth.width() : int(frame.depth.size())));
  out.u32(4);
  std::uint32_t at = 0;
  for (const char* name : {"rgb", "x", "y", "z"}) {
    out.text(name);
    out.u32(at);
    at += 4;
    out.u8(7);
    out.u32(1);
  }
  out.u8(0);
  out.u32(at);
  out.u32(at * static_cast<std::uint32_t>(in_rows ? frame.depth.width() : int(frame.depth.size())));
  std::string data;
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u) {
      const float z = float(frame.depth(u, v)) / 1e3F;
      const Eigen::Vector3f p = frame.camera.point(float(u), float(v), z > 0.F ? z : NAN);
      const Rgb c = frame.colour.empty() ? Rgb{} : frame.colour(u, v);
      const auto rgb = static_cast<std::uint32_t>(c.r << 16 | c.g << 8 | c.b);
      const std::array<float, 4> all{std::bit_cast<float>(rgb), p.x(), p.y(), p.z()};
      data.append(reinterpret_cast<const char*>(all.data()), sizeof(all));
    }
  }
  out.bytes(data);
  out.u8(0);
  return out.message();
}

TEST_F(RecordedTopics, PointsInRowsAreDepthWithTheirCamera) {
  out_.put("/camera/depth/points", "sensor_msgs/msg/PointCloud2", 0, points_message(a_, true));
  const auto source = open();
  const Frame frame = *source->next();
  EXPECT_EQ(frame.depth, a_.depth);
  EXPECT_EQ(frame.colour, a_.colour);
  EXPECT_NEAR(frame.camera.fx, a_.camera.fx, 0.01F);
  EXPECT_NEAR(frame.camera.cy, a_.camera.cy, 0.01F);
  EXPECT_EQ(item_of(*source, "/camera/depth/points").use, "depth");
  EXPECT_THAT(item_of(*source, "/camera/depth/points").holds, HasSubstr("xyz rgb"));
}

TEST_F(RecordedTopics, BothPicturesInOneMessageAreNamed) {
  out_.put("/camera/rgbd", "realsense2_camera_msgs/msg/RGBD", 0, "unread");
  EXPECT_THAT(error_of([&] { open(); }),
              AllOf(HasSubstr("/camera/rgbd"), HasSubstr("depth and colour in one message")));
}

TEST_F(RecordedTopics, PointsInNoRowsAreNamed) {
  out_.put("/camera/depth/points", "sensor_msgs/msg/PointCloud2", 0, points_message(a_, false));
  EXPECT_THAT(error_of([&] { open(); }), AllOf(HasSubstr("no depth"), HasSubstr("/camera/depth/points"),
                                               HasSubstr("points are read where they lie in rows")));
}

TEST_F(RecordedTopics, PicturesOfDepthComeBeforePoints) {
  out_.put("/camera/depth/points", "sensor_msgs/msg/PointCloud2", 0,
           points_message(random_frame("p", 9, 40, 30), true));
  out_.camera("/camera/depth/camera_info", a_.camera);
  out_.depth("/camera/depth/image", 0, a_);
  const auto source = open();
  EXPECT_THAT(source->notes(), IsEmpty());
  EXPECT_EQ(source->next()->depth, a_.depth);
}

TEST_F(RecordedTopics, ACalibrationOfLargerPicturesIsScaled) {
  Camera twice = a_.camera;
  twice.width *= 2;
  twice.height *= 2;
  out_.camera("/depth/camera_info", twice);
  out_.depth("/depth/image", 0, a_);
  const auto source = open();
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("for 80x60 pixels, scaled to 40x30")));
  const Camera camera = source->next()->camera;
  EXPECT_FLOAT_EQ(camera.fx, a_.camera.fx / 2.F);
  EXPECT_FLOAT_EQ(camera.cx, (a_.camera.cx + 0.5F) / 2.F - 0.5F);
}

TEST_F(RecordedTopics, CalibrationsThatDoNotFitAreNamed) {
  Camera other = a_.camera;
  other.width = 50;
  out_.camera("/depth/camera_info", other);
  out_.camera("/other/camera_info", {40, 30, 0.F, 0.F, 0.F, 0.F});
  out_.camera("/third/camera_info", a_.camera, "elsewhere");
  out_.depth("/depth/image", 0, a_);
  EXPECT_THAT(error_of([&] { open(); }),
              AllOf(HasSubstr("no intrinsics"), HasSubstr("50x30"), HasSubstr("not for the 40x30 pixels of depth"),
                    HasSubstr("all zeros"), HasSubstr("of the coordinate frame elsewhere, depth of depth_frame")));
}

TEST_F(RecordedTopics, TheCalibrationBesideDepthMayNameAnotherFrame) {
  out_.camera("/depth/camera_info", a_.camera, "depth_link");
  out_.depth("/depth/image", 0, a_);
  const auto source = open();
  EXPECT_THAT(source->notes(), ElementsAre(AllOf(HasSubstr("depth_link"), HasSubstr("depth_frame"))));
  EXPECT_EQ(source->next()->camera, a_.camera);
}

TEST_F(RecordedTopics, AFrameWithASlashIsTheSame) {
  out_.depth("/d/image", 0, a_, "/cam");
  out_.colour("/c/image", 0, a_, "cam");
  out_.camera("/d/camera_info", a_.camera, "cam");
  const auto source = open();
  EXPECT_EQ(item_of(*source, "/c/image").use, "colour");
  EXPECT_EQ(source->next().value().camera, a_.camera);
}

TEST_F(RecordedTopics, GreyIsColourWhereItIsCalledSo) {
  Image<std::uint8_t> grey(40, 30, 77);
  out_.camera("/depth/camera_info", a_.camera);
  out_.depth("/depth/image", 0, a_);
  out_.put("/color/image", kImage, 0, grey_message(grey, 0, "depth_frame"));
  EXPECT_EQ(open()->next()->colour(3, 4), (Rgb{77, 77, 77}));
}

TEST_F(RecordedTopics, WhatIsNotReadAsColourIsNoted) {
  out_.camera("/depth/camera_info", a_.camera);
  out_.depth("/depth/image", 0, a_);
  out_.put("/left/image", kImage, 0, grey_message(Image<std::uint8_t>(40, 30, 77), 0, "depth_frame"));
  out_.put("/color/image", kImage, 0, raw("yuv444p10", a_.depth));
  out_.put("/color/image/compressed", kCompressed, 0, packed("h264", "a picture and what changed since"));
  out_.put("/color/video", "theora_image_transport/msg/Packet", 0, "x");
  const auto source = open();
  EXPECT_THAT(source->notes(),
              ElementsAre(AllOf(HasSubstr("no colour, since"), HasSubstr("/left/image (mono8): grey"),
                                HasSubstr("--colour-topic takes it"), HasSubstr("/color/image (yuv444p10)"),
                                HasSubstr("/color/image/compressed (h264)"), HasSubstr("/color/video"))));
  SourceOptions options;
  options.colour_topic = "/left/image";
  EXPECT_EQ(open_source(folder_ / "a.mcap", options)->next()->colour(3, 4), (Rgb{77, 77, 77}));
}

TEST_F(RecordedTopics, ColourOnAnotherClockIsNoted) {
  out_.camera("/depth/camera_info", a_.camera);
  out_.put("/depth/image", kImage, 0, depth_message(a_.depth, 5000 * kMs, "depth_frame"));
  out_.put("/rgb/image", kImage, 0, colour_message(a_.colour, 105'000 * kMs, "depth_frame"));
  EXPECT_THAT(open()->notes(), ElementsAre(AllOf(HasSubstr("no colour within 50 ms"), HasSubstr("100 s"))));
}

TEST_F(RecordedTopics, ColourThatBeginsLaterIsNotOnAnotherClock) {
  out_.camera("/depth/camera_info", a_.camera);
  out_.depth("/depth/image", 0, a_);
  out_.colour("/rgb/image", 3000 * kMs, a_);
  out_.depth("/depth/image", 3010 * kMs, a_);
  EXPECT_THAT(open()->notes(), IsEmpty());
}

/// As Orbbec's SDK 2 writes them: an Image with numbers behind it, some with a camera's own bytes in front of the
/// picture.
std::string orbbec_image(const std::string& encoding, int width, int height, int row_bytes, const std::string& data,
                         const std::string& own) {
  ByteWriter out;
  for (const int word : {0, 60, 0, 0, height, width}) out.number(static_cast<std::uint32_t>(word));
  out.text(encoding);
  out.number(std::uint8_t{0});
  out.number(static_cast<std::uint32_t>(row_bytes));
  if (!own.empty()) out.number(static_cast<std::uint32_t>(own.size()));
  out.text(own + data);
  for (int i = 0; i < 4; ++i) out.number(std::uint64_t{60'000'000});
  if (own.empty()) out.text("");
  if (own.empty()) out.number(std::uint32_t{0});
  return out.bytes();
}

std::string orbbec_profile(std::uint8_t stream, const Camera& camera, float aside_mm) {
  ByteWriter out;
  for (const std::uint32_t word : {0, 60, 0, 0}) out.number(word);
  out.number(stream);
  out.number(std::uint8_t{28});
  for (const float r : {1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, aside_mm, 0.F, 0.F}) out.real(r);
  for (const int side : {camera.width, camera.height, 30}) out.number(static_cast<std::uint16_t>(side));
  for (const float k : {camera.fx, camera.fy, camera.cx, camera.cy}) out.real(k);
  for (int i = 0; i < 8; ++i) out.real(0.F);
  out.number(std::uint8_t{4});
  return out.bytes();
}

TEST(OrbbecTopics, AreReadWithCamerasAndColour) {
  const Frame a = random_frame("a", 1, 40, 30);
  const DepthImage infrared(40, 30, 5000);
  const auto bytes = [](const DepthImage& depth) {
    return std::string(reinterpret_cast<const char*>(depth.data()), depth.size() * 2);
  };
  for (const std::string& own : {std::string(), std::string("metadata")}) {
    test::Bag bag;
    const std::int64_t time_ns = 60 * kNanoseconds;
    bag.put("/cam/sensor_6/frameType_8", "sensor_msgs/Image", time_ns,
            orbbec_image("mono16", 40, 30, 80, bytes(infrared), own));
    bag.put("/cam/sensor_3/frameType_3", "sensor_msgs/Image", time_ns,
            orbbec_image("mono16", 40, 30, 80, bytes(a.depth), own));
    bag.put("/cam/sensor_2/frameType_2", "sensor_msgs/Image", time_ns,
            orbbec_image("mjpg", 40, 30, 0, encode_jpeg(a.colour, 95), own));
    bag.put("/cam/streamProfileType_3", "custom_msg/OBStreamProfileInfo", time_ns, orbbec_profile(3, a.camera, 0.F));
    bag.put("/cam/streamProfileType_2", "custom_msg/OBStreamProfileInfo", time_ns, orbbec_profile(2, a.camera, 0.F));
    const test::TemporaryFolder folder;
    const auto source = open_source(test::put(folder / "a.bag", bag.bytes()));
    EXPECT_EQ(source->next().value().depth, a.depth);
    EXPECT_EQ(item_of(*source, "/cam/sensor_2/frameType_2").use, "colour");
    EXPECT_EQ(item_of(*source, "/cam/streamProfileType_3").use, "camera of depth");
    const Frame again = *open_source(folder / "a.bag")->next();
    EXPECT_EQ(again.camera, a.camera);
    ASSERT_FALSE(again.colour.empty());
    EXPECT_EQ(again.time_s, 60.0);
  }
}

}  // namespace
}  // namespace vesalius
