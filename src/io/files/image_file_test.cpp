#include "vesalius/image_file.h"

#include <gmock/gmock.h>
#include <turbojpeg.h>

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
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

/// What OpenCV makes of a picture.
ColourImage decoded_by_opencv(const std::string& bytes) {
  const std::vector<unsigned char> raw(bytes.begin(), bytes.end());
  const cv::Mat mat = cv::imdecode(raw, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  ColourImage image(mat.cols, mat.rows);
  for (int v = 0; v < mat.rows; ++v) {
    for (int u = 0; u < mat.cols; ++u) {
      const auto bgr = mat.at<cv::Vec3b>(v, u);
      image(u, v) = {bgr[2], bgr[1], bgr[0]};
    }
  }
  return image;
}

TEST(ImageFile, ReadsPicturesOfAllKindsAsOpenCvDoes) {
  cv::Mat bgr(37, 53, CV_8UC3), deep(37, 53, CV_16UC3), grey(37, 53, CV_16UC1);
  for (cv::Mat* mat : {&bgr, &deep, &grey}) cv::randu(*mat, 0, mat == &bgr ? 255 : 65535);
  cv::blur(bgr, bgr, {5, 5});
  for (const std::string& picture :
       {encoded(".jpg", bgr), encoded(".jpg", bgr, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
        encoded(".jpg", bgr, {cv::IMWRITE_JPEG_RST_INTERVAL, 2}), encoded(".jpg", bgr.reshape(1, 37)),
        encoded(".png", bgr), encoded(".png", deep), encoded(".png", grey),
        encoded(".png", bgr.reshape(1, 37) > 100, {cv::IMWRITE_PNG_BILEVEL, 1})}) {
    EXPECT_EQ(decode_colour(picture, "a"), decoded_by_opencv(picture));
  }
}

TEST(ImageFile, WritesPicturesThatOpenCvReads) {
  const Frame frame = random_frame("f", 5);
  EXPECT_EQ(decoded_by_opencv(encode_png(frame.colour)), frame.colour);
  const std::string jpeg = encode_jpeg(frame.colour, 90);
  EXPECT_EQ(decoded_by_opencv(jpeg), decode_colour(jpeg, "a.jpg"));
  const std::string depth = encode_png(frame.depth);
  const cv::Mat mat = cv::imdecode(std::vector<unsigned char>(depth.begin(), depth.end()), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(mat.type(), CV_16UC1);
  EXPECT_TRUE(std::equal(frame.depth.begin(), frame.depth.end(), mat.begin<std::uint16_t>(), mat.end<std::uint16_t>()));
}

TEST(ImageFile, SaysThatAJpegIsOfInks) {
  const auto free = [](void* handle) { tjDestroy(handle); };
  const std::unique_ptr<void, decltype(free)> encoder(tjInitCompress(), free);
  const std::vector<unsigned char> inks(std::size_t{16} * 16 * 4, 90);
  unsigned char* made = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(tjCompress2(encoder.get(), inks.data(), 16, 0, 16, TJPF_CMYK, &made, &size, TJSAMP_444, 90, 0), 0);
  const std::string jpeg(reinterpret_cast<const char*>(made), size);
  tjFree(made);
  EXPECT_EQ(error_of([&] { decode_colour(jpeg, "a.jpg"); }), "a.jpg: JPEG of CMYK, expected RGB or grey");
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
  EXPECT_THAT(error_of([] { decode_depth_png("\xFF\xD8\xFF\xE0", "d.png"); }),
              HasSubstr("d.png: a JPEG, which cannot hold depth"));
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

TEST(ImageFile, RefusesDataWhoseOwnChecksumIsWrong) {
  const DepthImage depth = random_frame("f", 4, 30, 40).depth;
  const std::string png = encode_png(depth);  // 33 bytes of signature and header, one chunk of data, the end's 12
  std::string data = png.substr(41, png.size() - 41 - 4 - 12);
  const auto decoded = [&] {
    return decode_depth_png(png.substr(0, 33) + chunk("IDAT", data) + chunk("IEND", ""), "d.png");
  };
  EXPECT_EQ(decoded(), depth);
  data.back() = static_cast<char>(data.back() + 1);
  EXPECT_THAT(error_of(decoded), HasSubstr("d.png: damaged picture"));
}

TEST(ImageFile, RefusesToWriteAnEmptyPicture) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { write_png(DepthImage(), folder / "d.png"); }), HasSubstr("d.png: picture cannot"));
  EXPECT_EQ(folder.file_count(), 0U);
  EXPECT_THAT(error_of([] { encode_jpeg(ColourImage(), 90); }), HasSubstr("picture cannot"));
}

}  // namespace
}  // namespace vesalius
