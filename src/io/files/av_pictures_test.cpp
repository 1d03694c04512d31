#include "io/files/av_pictures.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "io/files/byte_stream.h"
#include "io/files/depth_picture.h"
#include "io/files/image_bytes.h"
#include "io/files/test_files.h"
#include "io/files/video_stream.h"
#include "io/recordings/message_fields.h"
#include "io/sources/test_messages.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"
#ifdef VESALIUS_TEST_VIDEO
#include "io/files/test_video.h"
#endif

namespace vesalius {
namespace {

using test::error_of;
using testing::HasSubstr;

/// Returns a picture as OpenCV writes it.
std::string packed(const std::string& extension, const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, picture, bytes, {cv::IMWRITE_WEBP_QUALITY, 101});
  return {bytes.begin(), bytes.end()};
}

cv::Mat whole_numbers() {
  cv::Mat depth(30, 40, CV_16UC1);
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(1000 + 300 * v + u);
  }
  return depth;
}

cv::Mat metres() {
  cv::Mat depth;
  whole_numbers().convertTo(depth, CV_32F, 0.001);
  return depth;
}

class AvPictures : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_avcodec()) GTEST_SKIP() << "built without libavcodec";
  }
};

TEST_F(AvPictures, TiffOfSixteenBitsIsDepth) {
  const DepthPicture depth = decode_depth(packed(".tiff", whole_numbers()), "a.tiff");
  ASSERT_EQ(depth.whole.width(), 40);
  EXPECT_EQ(depth.whole(3, 2), 1603);
  EXPECT_EQ(depth.whole(39, 29), 9739);
}

TEST_F(AvPictures, WebPTiffAndBmpAreColour) {
  cv::Mat colours(30, 40, CV_8UC3);
  for (int i = 0; i < 30 * 40; ++i) colours.at<cv::Vec3b>(i / 40, i % 40) = {7, static_cast<uchar>(i % 40 * 5), 200};
  for (const char* extension : {".webp", ".tiff", ".bmp"}) {
    const ColourImage colour = decode_colour(packed(extension, colours), extension);
    ASSERT_EQ(colour.width(), 40) << extension;
    EXPECT_EQ(colour(4, 3), (Rgb{200, 20, 7})) << extension;
  }
}

TEST_F(AvPictures, OfTheOtherSortAreRefused) {
  EXPECT_THAT(error_of([] { decode_colour(packed(".tiff", whole_numbers()), "a.tiff"); }),
              HasSubstr("expected colours"));
  EXPECT_THAT(error_of([] {
                decode_depth(packed(".webp", cv::Mat(30, 40, CV_8UC3, {1, 2, 3})), "a.webp");
              }),
              HasSubstr("a.webp: WebP of 8 bits"));
}

TEST_F(AvPictures, DamageIsNamed) {
  for (const char* extension : {".tiff", ".webp"}) {
    const cv::Mat picture = std::string(extension) == ".webp" ? cv::Mat(30, 40, CV_8UC3, {1, 2, 3}) : metres();
    const std::string whole = packed(extension, picture);
    for (std::size_t size = 4; size + 8 < whole.size() && size < 64; size += 7) {
      EXPECT_THAT(error_of([&] { decode_av_picture(whole.substr(0, size), "cut"); }), HasSubstr("cut")) << extension;
    }
  }
}

TEST_F(AvPictures, AFolderMayHaveThem) {
  const test::TemporaryFolder folder;
  test::put(folder / "camera.toml", "fx = 30.0\nfy = 30.0\ncx = 20.0\ncy = 15.0\n");
  test::put(folder / "depth/1.tif", packed(".tif", whole_numbers()));
  test::put(folder / "rgb/1.webp", packed(".webp", cv::Mat(30, 40, CV_8UC3, {7, 20, 200})));
  const auto frame = open_source(folder / "")->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth(3, 2), 1603);
  EXPECT_EQ(frame->colour(3, 2), (Rgb{200, 20, 7}));
}

TEST(VideoCodec, IsKnownByTheNamesOfMessages) {
  for (const char* name : {"h264", "libx264", "H.264", "h264;yuv420p;bgr8", "avc1"})
    EXPECT_EQ(video_codec(name), "h264");
  for (const char* name : {"h265", "hevc", "libx265", "hevc_nvenc"}) EXPECT_EQ(video_codec(name), "hevc");
  for (const char* name : {"jpeg", "png", "bgr8; jpeg compressed bgr8", "av1", "vp9", ""})
    EXPECT_EQ(video_codec(name), "");
}

TEST(VideoCodec, BeginsWithParameterSets) {
  using namespace std::literals;
  EXPECT_TRUE(is_key_message("h264", "\0\0\0\1\x67..\0\0\1\x68.\0\0\1\x65..."sv));
  EXPECT_FALSE(is_key_message("h264", "\0\0\1\x41..."sv));
  EXPECT_TRUE(is_key_message("hevc", "\0\0\1\x40\1.\0\0\1\x42\1.\0\0\1\x26\1.."sv));
  EXPECT_FALSE(is_key_message("hevc", "\0\0\1\x02\1.."sv));
  EXPECT_FALSE(is_key_message("h264", "\0\0\1"sv));
}

#ifdef VESALIUS_TEST_VIDEO

TEST_F(AvPictures, OpenExrIsDepthInMetres) {
  Image<float> metres(40, 30);
  for (int i = 0; i < 40 * 30; ++i) metres(i % 40, i / 40) = 1.F + 0.3F * float(i / 40) + 0.001F * float(i % 40);
  const std::string bytes = test::encode_exr(metres);
  if (bytes.empty()) GTEST_SKIP() << "libavcodec writes no OpenEXR";
  const DepthPicture depth = decode_depth(bytes, "a.exr");
  EXPECT_EQ(depth.real, metres);
  EXPECT_EQ(to_millimetres(depth, 1000.F, false)(3, 2), 1603);
  for (std::size_t size = 4; size < bytes.size(); ++size) {
    EXPECT_THAT(error_of([&] { decode_depth(bytes.substr(0, size), "cut"); }), HasSubstr("cut: damaged OpenEXR"))
        << size;
  }
}

/// Returns an OpenEXR file without compression of 4x3 pixels. Pixels of channel i are i + 1 and a bit.
std::string exr_of(const std::vector<std::string>& channels) {
  constexpr int kColumns = 4, kRows = 3;
  ByteWriter out;
  const auto text = [&](std::string_view word) {
    for (const char c : word) out.number(c);
    out.number('\0');
  };
  const auto numbers = [&](std::initializer_list<int> all) {
    for (const int one : all) out.number(one);
  };
  const auto attribute = [&](const char* name, const char* type, int size) {
    text(name);
    text(type);
    out.number(size);
  };
  numbers({20000630, 2});
  int size = 1;
  for (const std::string& name : channels) size += int(name.size()) + 17;
  attribute("channels", "chlist", size);
  for (const std::string& name : channels) {
    text(name);
    numbers({2, 0, 1, 1});
  }
  out.number('\0');
  attribute("compression", "compression", 1);
  out.number('\0');
  for (const char* window : {"dataWindow", "displayWindow"}) {
    attribute(window, "box2i", 16);
    numbers({0, 0, kColumns - 1, kRows - 1});
  }
  attribute("lineOrder", "lineOrder", 1);
  out.number('\0');
  attribute("pixelAspectRatio", "float", 4);
  out.real(1.F);
  attribute("screenWindowCenter", "v2f", 8);
  numbers({0, 0});
  attribute("screenWindowWidth", "float", 4);
  out.real(1.F);
  out.number('\0');
  const int row_bytes = int(channels.size()) * kColumns * 4;
  const std::uint64_t first = out.bytes().size() + 8 * kRows;
  for (int v = 0; v < kRows; ++v) out.number(first + std::uint64_t(v) * std::uint64_t(row_bytes + 8));
  for (int v = 0; v < kRows; ++v) {
    numbers({v, row_bytes});
    for (std::size_t c = 0; c < channels.size(); ++c) {
      for (int u = 0; u < kColumns; ++u) out.real(float(c + 1) + 0.25F * float(u) + 0.0625F * float(v));
    }
  }
  return out.bytes();
}

TEST_F(AvPictures, OpenExrHasItsDepthInWhateverChannelSaysSo) {
  const auto at = [](const std::vector<std::string>& channels) {
    return decode_depth(exr_of(channels), "a.exr").real(2, 1);
  };
  for (const char* one : {"Y", "R", "Z", "V", "A", "Depth.Z", "depth", "ViewLayer.Depth.V"}) {
    EXPECT_EQ(at({one}), 1.5625F) << one;
  }
  EXPECT_EQ(at({"B", "G", "R", "Z"}), 4.5625F);
  EXPECT_EQ(at({"A", "Combined.B", "Combined.G", "Combined.R", "Depth.Z"}), 5.5625F);
  EXPECT_EQ(at({"B", "G", "R", "depth"}), 4.5625F);
  for (const std::vector<std::string>& none : {std::vector<std::string>{"B", "G", "R"}, {"X", "Y", "Z"}}) {
    EXPECT_THAT(error_of([&] { at(none); }), HasSubstr("a.exr: OpenEXR of colours, expected one channel, or Z"));
  }
}

constexpr int kWidth = 64, kHeight = 48, kPictures = 24, kGroup = 8;
constexpr std::int64_t kApart_ns = 33'000'000, kFirst_ns = 1'000'000'000;

std::int64_t time_of(int picture) { return kFirst_ns + picture * kApart_ns; }

class Video : public testing::TestWithParam<const char*> {
 protected:
  std::vector<test::VideoMessage> video(int between = 0) const {
    return test::encode_video(GetParam(), kWidth, kHeight, kPictures, kGroup, between);
  }
  std::string codec() const { return std::string(video_codec(GetParam())); }

  /// A recording of depth, whose pictures have the times of the video's, and the messages of that.
  std::string record(const std::vector<test::VideoMessage>& messages,
                     const std::string& type = "foxglove_msgs/msg/CompressedVideo") {
    const std::string path = folder_ / (std::to_string(recorded_++) + ".mcap");
    test::Messages out(path);
    Frame frame = test::random_frame("a", 1, kWidth, kHeight);
    frame.camera = {kWidth, kHeight, 50.F, 50.F, 32.F, 24.F};
    out.camera("/depth/camera_info", frame.camera);
    int i = messages.front().picture;
    for (const test::VideoMessage& message : messages) {
      out.put("/color/video", type, time_of(i), packet(message, type));
      out.depth("/depth/image", time_of(i++), frame);
    }
    out.close();
    return path;
  }

  std::string packet(const test::VideoMessage& message, const std::string& type) const {
    CdrWriter out;
    out.header(time_of(message.picture), "depth_frame");
    if (type == "sensor_msgs/msg/CompressedImage") out.text(codec());
    if (type.ends_with("FFMPEGPacket")) {
      out.u32(kWidth);
      out.u32(kHeight);
      out.text(GetParam());
      out.real64(0.0);  // eight bytes, as of the packet's time
      out.u8(1);
      out.u8(0);
    }
    out.bytes(message.bytes);
    if (type.ends_with("CompressedVideo")) out.text(codec() == "hevc" ? "h265" : "h264");
    return out.message();
  }

  test::TemporaryFolder folder_;
  int recorded_ = 0;
};

/// How bright the middle of a grey picture is that was encoded as 16 to 235.
int grey_in(const ColourImage& colour) { return colour.empty() ? -1 : colour(kWidth / 2, kHeight / 2).g; }
int full_range(int grey) { return (grey - 16) * 255 / 219; }

TEST_P(Video, IsDecodedOneAfterTheOther) {
  const auto messages = video();
  if (messages.empty()) GTEST_SKIP() << "libavcodec has no " << GetParam();
  VideoDecoder decoder(codec());
  std::vector<VideoDecoder::Picture> all;
  for (const auto& message : messages) {
    for (auto& picture : decoder.decode(message.bytes, message.picture)) all.push_back(std::move(picture));
  }
  for (auto& picture : decoder.decode({}, 0)) all.push_back(std::move(picture));
  ASSERT_EQ(all.size(), std::size_t(kPictures));
  for (int i = 0; i < kPictures; ++i) {
    EXPECT_EQ(all[std::size_t(i)].time_ns, i);
    EXPECT_NEAR(grey_in(all[std::size_t(i)].colour), full_range(test::grey_of(i)), 3);
  }
  EXPECT_EQ(video_size(codec(), messages[0].bytes), std::pair(kWidth, kHeight));
  EXPECT_EQ(video_size(codec(), messages[1].bytes), std::pair(0, 0));
}

TEST_P(Video, IsTheColourOfItsTime) {
  for (const int between : {0, 2}) {
    const auto messages = video(between);
    if (messages.empty()) GTEST_SKIP() << "libavcodec has no " << GetParam();
    for (const char* type : {"foxglove_msgs/msg/CompressedVideo", "ffmpeg_image_transport_msgs/msg/FFMPEGPacket",
                             "sensor_msgs/msg/CompressedImage"}) {
      const auto source = open_source(record(messages, type));
      for (int i = 0; i < kPictures; ++i) {
        const auto frame = source->next();
        ASSERT_TRUE(frame);
        EXPECT_NEAR(grey_in(frame->colour), full_range(test::grey_of(i)), 3) << type << " " << i << " " << between;
      }
    }
  }
}

TEST_P(Video, IsTheSameAfterASeek) {
  const auto messages = video();
  if (messages.empty()) GTEST_SKIP() << "libavcodec has no " << GetParam();
  const auto source = open_source(record(messages));
  std::vector<ColourImage> colours;
  while (const auto frame = source->next()) colours.push_back(frame->colour);
  for (const int to : {kGroup + 5, kPictures - 1, 2, kGroup}) {
    source->seek(1e-9 * double(time_of(to)) - 1e-3);
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->colour, colours[std::size_t(to)]) << to;
  }
}

TEST_P(Video, ThatBeginsInTheMiddleHasColourFromTheNextBeginning) {
  auto messages = video();
  if (messages.empty()) GTEST_SKIP() << "libavcodec has no " << GetParam();
  messages.erase(messages.begin(), messages.begin() + 3);
  const auto source = open_source(record(messages));
  std::vector<int> greys;
  while (const auto frame = source->next()) greys.push_back(grey_in(frame->colour));
  ASSERT_EQ(greys.size(), messages.size());
  EXPECT_EQ(greys.front(), -1);
  EXPECT_NEAR(greys.back(), full_range(test::grey_of(kPictures - 1)), 3);
}

TEST_P(Video, WithoutABeginningIsNamed) {
  auto messages = video();
  if (messages.empty()) GTEST_SKIP() << "libavcodec has no " << GetParam();
  messages.resize(kGroup);
  messages.erase(messages.begin());
  EXPECT_THAT(open_source(record(messages))->notes(), testing::Contains(HasSubstr("without others before it")));
}

TEST_P(Video, DamageLosesColourAlone) {
  const auto whole = video();
  if (whole.empty()) GTEST_SKIP() << "libavcodec has no " << GetParam();
  for (unsigned seed = 0; seed < 20; ++seed) {
    auto messages = whole;
    for (auto& message : messages) {
      std::string& bytes = message.bytes;
      if (&message != messages.data())
        bytes[(seed * 7919 + bytes.size()) % bytes.size()] ^= static_cast<char>(1 + seed);
    }
    const auto source = open_source(record(messages));
    int frames = 0;
    while (source->next()) ++frames;
    EXPECT_EQ(frames, kPictures);
  }
}

INSTANTIATE_TEST_SUITE_P(Codecs, Video, testing::Values("libx264", "libx265"),
                         [](const auto& codec) { return std::string(codec.param); });

#endif

}  // namespace
}  // namespace vesalius
