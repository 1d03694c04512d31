#include "io/recordings/camera_messages.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::HasSubstr;

PictureMessage picture(const std::string& encoding, int width, int height, std::uint32_t row_bytes,
                       const std::string& data) {
  PictureMessage made;
  made.width = width;
  made.height = height;
  made.encoding = encoding;
  made.row_bytes = row_bytes;
  made.data = data;
  return made;
}

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

// Red, green and blue of full strength, black and white, as BT.601 has them.
TEST(ColourOf, Yuy2) {
  const std::string data = bytes({81, 90, 81, 240, 145, 54, 145, 34, 41, 240, 16, 110, 235, 128, 16, 128});
  const ColourImage colour = colour_of(picture("yuv422_yuy2", 4, 2, 8, data), "here");
  EXPECT_EQ(colour(0, 0), (Rgb{255, 0, 0}));
  EXPECT_EQ(colour(1, 0), (Rgb{255, 0, 0}));
  EXPECT_EQ(colour(2, 0), (Rgb{0, 255, 1}));
  EXPECT_EQ(colour(0, 1).b, 255);
  EXPECT_EQ(colour(2, 1), (Rgb{255, 255, 255}));
  EXPECT_EQ(colour(3, 1), (Rgb{0, 0, 0}));
  EXPECT_THAT(error_of([&] { colour_of(picture("yuv422_yuy2", 1, 2, 8, data), "here"); }),
              HasSubstr("here: yuv422_yuy2 of 1 columns, expected an even number"));
}

TEST(ColourOf, Nv12) {
  const std::string data = bytes({81, 81, 235, 16, 81, 81, 16, 235, 90, 240, 128, 128});
  const ColourImage colour = colour_of(picture("nv12", 4, 2, 4, data), "here");
  for (const int v : {0, 1}) {
    EXPECT_EQ(colour(0, v), (Rgb{255, 0, 0}));
    EXPECT_EQ(colour(1, v), (Rgb{255, 0, 0}));
    EXPECT_EQ(colour(v == 0 ? 2 : 3, v), (Rgb{255, 255, 255}));
    EXPECT_EQ(colour(v == 0 ? 3 : 2, v), (Rgb{0, 0, 0}));
  }
  EXPECT_THAT(error_of([&] { colour_of(picture("nv12", 4, 2, 4, data.substr(0, 11)), "here"); }),
              HasSubstr("nv12 of 4x2 with 11 bytes, expected even sides and 12 bytes"));
}

Calibration calibration_of(int width, int height, double focal, double cx, double cy) {
  Calibration c;
  c.width = width;
  c.height = height;
  c.matrix = {focal, 0, cx, 0, focal, cy, 0, 0, 1};
  return c;
}

TEST(ScaledTo, GoesByWholeRatiosOfBothSides) {
  const Calibration c = calibration_of(640, 480, 500, 319.5, 239.5);
  EXPECT_EQ(scaled_to(c, 640, 480)->matrix, c.matrix);
  EXPECT_THAT(scaled_to(c, 160, 120)->matrix, testing::ElementsAre(125, 0, 79.5, 0, 125, 59.5, 0, 0, 1));
  EXPECT_THAT(scaled_to(c, 1280, 960)->matrix, testing::ElementsAre(1000, 0, 639.5, 0, 1000, 479.5, 0, 0, 1));
  for (const auto& [width, height] : {std::pair(320, 480), {480, 360}, {640, 360}, {0, 0}}) {
    EXPECT_FALSE(scaled_to(c, width, height)) << width;
  }
}

TEST(ScaledTo, PartsAndBinsAreAsTheCalibrationSays) {
  Calibration c = calibration_of(640, 480, 500, 319.5, 239.5);
  c.roi_x = 100;
  c.roi_y = 40;
  c.roi_width = 200;
  c.roi_height = 100;
  EXPECT_EQ(scaled_to(c, 200, 100)->matrix[2], 219.5);
  c.binning_x = c.binning_y = 2;
  const Calibration scaled = scaled_to(c, 100, 50).value();
  EXPECT_EQ(scaled.matrix[0], 250);
  EXPECT_EQ(scaled.matrix[2], 109.5);
  EXPECT_EQ(scaled.matrix[5], 99.5);
  EXPECT_EQ(scaled_to(c, 640, 480)->matrix, c.matrix) << "drivers that say one thing and record another";
}

}  // namespace
}  // namespace vesalius
