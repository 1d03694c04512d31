#include "io/recordings/colour_encodings.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/recordings/picture_message.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::HasSubstr;

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

ColourImage decoded(const std::string& encoding, int width, int height, int row_bytes, const std::string& data,
                    bool big_endian = false) {
  PictureMessage made;
  made.width = width;
  made.height = height;
  made.encoding = encoding;
  made.row_bytes = static_cast<std::uint32_t>(row_bytes);
  made.data = data;
  made.big_endian = big_endian;
  return decode_raw_colour(made, "here");
}

// Red as BT.601 has it: Y 81, U 90, V 240; white: 235, 128, 128.
TEST(ColourEncodings, PairsOfPixels) {
  for (const char* uyvy : {"yuv422", "uyvy", "UYVY"}) {
    const ColourImage colour = decoded(uyvy, 4, 1, 8, bytes({90, 81, 240, 81, 128, 235, 128, 16}));
    EXPECT_EQ(colour(1, 0), (Rgb{255, 0, 0})) << uyvy;
    EXPECT_EQ(colour(2, 0), (Rgb{255, 255, 255})) << uyvy;
    EXPECT_EQ(colour(3, 0), (Rgb{0, 0, 0})) << uyvy;
  }
  for (const char* yuyv : {"yuv422_yuy2", "yuyv", "YUY2"}) {
    EXPECT_EQ(decoded(yuyv, 2, 1, 4, bytes({81, 90, 235, 240}))(0, 0), (Rgb{255, 0, 0})) << yuyv;
  }
}

TEST(ColourEncodings, Planes) {
  const std::string luminance = bytes({81, 81, 235, 16, 81, 81, 16, 235});
  for (const auto& [encoding, chrominance] : {std::pair("nv12", bytes({90, 240, 128, 128})),
                                              {"nv21", bytes({240, 90, 128, 128})},
                                              {"i420", bytes({90, 128, 240, 128})},
                                              {"yv12", bytes({240, 128, 90, 128})}}) {
    const ColourImage colour = decoded(encoding, 4, 2, 4, luminance + chrominance);
    EXPECT_EQ(colour(1, 1), (Rgb{255, 0, 0})) << encoding;
    EXPECT_EQ(colour(2, 0), (Rgb{255, 255, 255})) << encoding;
    EXPECT_EQ(colour(2, 1), (Rgb{0, 0, 0})) << encoding;
    EXPECT_THAT(error_of([&, name = encoding] { decoded(name, 4, 2, 4, luminance); }),
                HasSubstr("expected even sides and 12 bytes"));
  }
}

TEST(ColourEncodings, BayerPatternsGiveTheColoursOfTwoByTwo) {
  const Rgb one{10, 20, 30};
  for (const auto& [encoding, data] : {std::pair("bayer_rggb8", bytes({10, 18, 22, 30})),
                                       {"bayer_bggr8", bytes({30, 18, 22, 10})},
                                       {"bayer_gbrg8", bytes({18, 30, 10, 22})},
                                       {"bayer_grbg8", bytes({18, 10, 30, 22})}}) {
    const ColourImage colour = decoded(encoding, 2, 2, 2, data);
    for (const Rgb& pixel : colour) EXPECT_EQ(pixel, one) << encoding;
  }
  EXPECT_EQ(decoded("bayer_rggb16", 2, 2, 4, bytes({1, 10, 1, 18, 1, 22, 1, 30}))(1, 1), one);
  EXPECT_EQ(decoded("bayer_rggb8", 3, 3, 3, bytes({10, 18, 0, 22, 30, 0, 0, 0, 0}))(2, 2), one) << "odd sides";
}

TEST(ColourEncodings, SixteenBitsAreCutToEight) {
  EXPECT_EQ(decoded("rgb16", 1, 1, 6, bytes({1, 10, 1, 20, 1, 30}))(0, 0), (Rgb{10, 20, 30}));
  EXPECT_EQ(decoded("bgr16", 1, 1, 6, bytes({1, 10, 1, 20, 1, 30}))(0, 0), (Rgb{30, 20, 10}));
  EXPECT_EQ(decoded("rgb16", 1, 1, 6, bytes({10, 1, 20, 1, 30, 1}), true)(0, 0), (Rgb{10, 20, 30}));
  EXPECT_EQ(decoded("mono16", 1, 1, 2, bytes({1, 10}))(0, 0), (Rgb{10, 10, 10}));
}

TEST(ColourEncodings, BytesAsOpenCvHasThem) {
  EXPECT_EQ(decoded("8UC4", 1, 1, 4, bytes({1, 2, 3, 4}))(0, 0), (Rgb{3, 2, 1}));
  EXPECT_EQ(decoded("8UC3", 1, 1, 3, bytes({1, 2, 3}))(0, 0), (Rgb{3, 2, 1}));
  EXPECT_EQ(decoded("8UC1", 1, 1, 1, bytes({7}))(0, 0), (Rgb{7, 7, 7}));
}

TEST(ColourEncodings, OthersAreNamed) {
  for (const char* other : {"yuv444", "bayer_rggb", "bayer_rgbg8", "", "h264"}) {
    EXPECT_FALSE(is_colour_encoding(other)) << other;
    EXPECT_THAT(error_of([&] { decoded(other, 1, 1, 4, "1234"); }), HasSubstr("here: colour encoded as"));
  }
}

}  // namespace
}  // namespace vesalius
