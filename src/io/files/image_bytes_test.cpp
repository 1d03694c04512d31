#include "io/files/image_bytes.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "io/files/test_files.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using test::error_of;
using test::random_frame;
using testing::HasSubstr;

std::string sample_png() { return encode_png(random_frame("f", 1, 12, 9).depth); }

std::string sample_jpeg(bool progressive) {
  std::vector<unsigned char> bytes;
  const cv::Mat picture(40, 60, CV_8UC3, cv::Scalar(10, 200, 30));
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, progressive ? 1 : 0});
  return {bytes.begin(), bytes.end()};
}

TEST(CheckPng, ReadsTheHeader) {
  const PngBytes png = check_png(sample_png(), "a.png");
  EXPECT_EQ(png.width, 12);
  EXPECT_EQ(png.height, 9);
  EXPECT_EQ(png.bit_depth, 16);
  EXPECT_EQ(png.colour_type, 0);
}

TEST(CheckPng, RefusesEveryTruncation) {
  const std::string whole = sample_png();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(check_png(whole.substr(0, size), "a.png"), Error) << "first " << size << " bytes";
  }
}

TEST(CheckPng, RefusesEveryFlippedByte) {
  const std::string whole = sample_png();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_THROW(check_png(damaged, "a.png"), Error) << "byte " << i;
  }
}

TEST(CheckPng, DropsChunksWithoutPixels) {
  std::string png = sample_png();
  // A tEXt chunk "a\0b" with its checksum is inserted after the header.
  const std::string text("\x00\x00\x00\x03tEXta\x00\x62\xDC\x49\xA2\x3B", 15);
  png.insert(33, text);
  EXPECT_EQ(check_png(png, "a.png").pixels, sample_png());
}

TEST(CheckPng, NamesTheFileAndThePlaceOfTheDamage) {
  EXPECT_EQ(error_of([] { check_png("", "a.png"); }), "a.png: empty file, expected a PNG");
  EXPECT_THAT(error_of([] { check_png("GIF89a", "a.png"); }), HasSubstr("a.png: no PNG signature"));
  std::string damaged = sample_png();
  damaged[20] = static_cast<char>(damaged[20] ^ 1);
  EXPECT_THAT(error_of([&] { check_png(damaged, "a.png"); }), HasSubstr("checksum of the chunk at byte 8"));
}

TEST(CheckJpeg, AcceptsBaselineAndProgressive) {
  check_jpeg(sample_jpeg(false), "a.jpg");
  check_jpeg(sample_jpeg(true), "a.jpg");
}

TEST(CheckJpeg, RefusesEveryTruncation) {
  for (const bool progressive : {false, true}) {
    const std::string whole = sample_jpeg(progressive);
    for (std::size_t size = 3; size < whole.size(); ++size) {
      EXPECT_THROW(check_jpeg(whole.substr(0, size), "a.jpg"), Error) << "first " << size << " bytes";
    }
  }
}

TEST(CheckJpeg, RefusesAHugeSizeBeforeDecoding) {
  std::string jpeg = sample_jpeg(false);
  const std::size_t frame = jpeg.find("\xFF\xC0");
  ASSERT_NE(frame, jpeg.npos);
  for (std::size_t i = 5; i < 9; ++i) jpeg[frame + i] = '\xFF';
  EXPECT_THAT(error_of([&] { check_jpeg(jpeg, "a.jpg"); }), HasSubstr("65535x65535"));
}

TEST(CheckJpeg, RefusesTooManyScans) {
  std::string jpeg = sample_jpeg(true);
  const std::size_t scan = jpeg.rfind("\xFF\xDA");
  const std::string last = jpeg.substr(scan, jpeg.size() - 2 - scan);
  for (int i = 0; i < 200; ++i) jpeg.insert(scan, last);
  EXPECT_THAT(error_of([&] { check_jpeg(jpeg, "a.jpg"); }), HasSubstr("scans"));
}

}  // namespace
}  // namespace vesalius
