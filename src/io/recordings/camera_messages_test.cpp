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

}  // namespace
}  // namespace vesalius
