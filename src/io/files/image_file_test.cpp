#include "io/files/image_file.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "io/files/image_bytes.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using test::put;
using test::random_frame;
using test::TemporaryFolder;
using testing::HasSubstr;

std::string encoded(const char* extension, const cv::Mat& mat, const std::vector<int>& parameters = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(extension, mat, bytes, parameters);
  return {bytes.begin(), bytes.end()};
}

TEST(ImageFile, KeepsEveryBitOfDepth) {
  const TemporaryFolder folder;
  DepthImage depth = random_frame("f", 2).depth;
  depth(0, 0) = 65535;
  depth(1, 0) = 1;
  write_png(depth, folder / "d.png");
  EXPECT_EQ(read_png16(folder / "d.png"), depth);
}

TEST(ImageFile, KeepsEveryBitOfMasksAndColour) {
  const TemporaryFolder folder;
  const Frame frame = random_frame("f", 3);
  write_png(frame.colour, folder / "c.png");
  EXPECT_EQ(read_colour(folder / "c.png"), frame.colour);
  Mask mask(5, 4);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = static_cast<std::uint8_t>(i * 13);
  write_png(mask, folder / "m.png");
  EXPECT_EQ(read_png8(folder / "m.png"), mask);
}

TEST(ImageFile, ReadsJpegChannelsAsRedGreenBlue) {
  const std::string jpeg = encoded(".jpg", cv::Mat(16, 16, CV_8UC3, cv::Scalar(20, 60, 220)));
  const ColourImage image = decode_colour(jpeg, "a.jpg");
  ASSERT_EQ(image.width(), 16);
  EXPECT_NEAR(image(8, 8).r, 220, 4);
  EXPECT_NEAR(image(8, 8).g, 60, 4);
  EXPECT_NEAR(image(8, 8).b, 20, 4);
}

TEST(ImageFile, IgnoresTheOrientationTagOfAJpeg) {
  // This Exif segment states orientation 6 (a quarter turn). The depth picture that belongs to it would not be turned.
  const std::string exif(
      "\xFF\xE1\x00\x22\x45xif\x00\x00II*\x00\x08\x00\x00\x00\x01\x00\x12\x01\x03\x00\x01\x00\x00\x00\x06\x00"
      "\x00\x00\x00\x00\x00\x00",
      36);
  std::string jpeg = encoded(".jpg", cv::Mat(8, 24, CV_8UC3, cv::Scalar(1, 2, 3)));
  jpeg.insert(2, exif);
  EXPECT_EQ(decode_colour(jpeg, "a.jpg").width(), 24);
}

TEST(ImageFile, ReadsGreyAndTransparentPicturesAsColour) {
  EXPECT_EQ(decode_colour(encoded(".png", cv::Mat(3, 4, CV_8UC1, cv::Scalar(77))), "a.png")(1, 1), (Rgb{77, 77, 77}));
  EXPECT_EQ(decode_colour(encoded(".png", cv::Mat(3, 4, CV_8UC4, cv::Scalar(1, 2, 3, 0))), "a.png")(1, 1),
            (Rgb{3, 2, 1}));
}

TEST(ImageFile, SaysWhyAPictureIsNotDepth) {
  const auto message = [](const cv::Mat& mat) {
    return error_of([&] { decode_depth_png(encoded(".png", mat), "d.png"); });
  };
  EXPECT_EQ(message(cv::Mat(3, 4, CV_8UC1, cv::Scalar(1))),
            "d.png: 8-bit grey PNG, expected 16-bit grey (depth, 0 = no reading)");
  EXPECT_THAT(message(cv::Mat(3, 4, CV_16UC3, cv::Scalar(1))), HasSubstr("16-bit colour PNG"));
  EXPECT_THAT(error_of([] { decode_depth_png("\xFF\xD8\xFF\xE0", "d.png"); }), HasSubstr("d.png: no PNG signature"));
  EXPECT_THAT(error_of([] { decode_colour("BM", "c.bmp"); }), HasSubstr("c.bmp: unknown kind of picture"));
  EXPECT_THAT(error_of([] { decode_colour("", "c.png"); }), HasSubstr("c.png: empty file"));
}

std::uint32_t crc(std::string_view bytes) {
  std::uint32_t value = ~0U;
  for (const char c : bytes) {
    value ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) value = (value & 1U) ? 0xEDB88320U ^ (value >> 1U) : value >> 1U;
  }
  return ~value;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift));
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc(type + data));
}

/// Returns a PNG whose checksums are right whatever its contents.
std::string forged_png(std::uint32_t width, std::uint32_t height, const std::string& data) {
  const std::string header = big_endian(width) + big_endian(height) + std::string("\x10\x00\x00\x00\x00", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", data) + chunk("IEND", "");
}

TEST(ImageFile, RefusesHostileHeadersBeforeDecoding) {
  const auto message = [](std::uint32_t width, std::uint32_t height) {
    return error_of([&] { decode_depth_png(forged_png(width, height, "xx"), "d.png"); });
  };
  EXPECT_THAT(message(0xFFFFFFFF, 0xFFFFFFFF), HasSubstr("d.png: picture of 4294967295x4294967295"));
  EXPECT_THAT(message(0, 5), HasSubstr("picture of 0x5"));
  EXPECT_THAT(message(8192, 8192), HasSubstr("too few"));
}

TEST(ImageFile, RefusesUndecodableData) {
  EXPECT_THAT(error_of([] { decode_depth_png(forged_png(4, 4, "not deflate"), "d.png"); }),
              HasSubstr("d.png: damaged picture"));
}

TEST(ImageFile, RefusesTooFewRows) {
  // The data has 40 rows, but the header claims 41.
  const std::string small = encode_png(random_frame("f", 4, 30, 40).depth);
  std::string header = small.substr(16, 13);
  header[7] = 41;
  const std::string forged = small.substr(0, 8) + chunk("IHDR", header) + small.substr(33);
  EXPECT_THAT(error_of([&] { decode_depth_png(forged, "d.png"); }), HasSubstr("d.png: damaged picture"));
}

TEST(ImageFile, RefusesToWriteAnEmptyPicture) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { write_png(DepthImage(), folder / "d.png"); }), HasSubstr("d.png: picture cannot"));
  EXPECT_EQ(folder.file_count(), 0U);
}

}  // namespace
}  // namespace vesalius
