#include "io/files/depth_picture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "io/files/av_pictures.h"
#include "io/files/test_files.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using namespace std::literals;
using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<int> values(const DepthImage& depth) { return {depth.begin(), depth.end()}; }

DepthImage read(const std::string& bytes, float units_per_m = 1000.F, bool of_real = false) {
  return to_millimetres(decode_depth(bytes, "d"), units_per_m, of_real);
}

/// An array as numpy.save writes it.
template <class T>
std::string npy(const char* type, const std::string& shape, const std::vector<T>& numbers, bool fortran = false) {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': ({}), }}", type, fortran ? "True" : "False", shape);
  header.resize(117, ' ');
  header += '\n';
  return "\x93NUMPY\x01\0"s + char(header.size()) + '\0' + header +
         std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
}

TEST(DepthPicture, ReadsPgm) {
  const std::string pixels = "\x03\xE8\x00\x00\xFF\xFF\x01\x02"s;
  EXPECT_THAT(values(read("P5\n# from a Kinect\n2 2\n65535\n" + pixels)), ElementsAre(1000, 0, 0, 258));
  EXPECT_THAT(values(read("P5 4 1 2047\n" + pixels)), ElementsAre(1000, 0, 0, 258)) << "65535 is no reading";
  EXPECT_THAT(error_of([&] { read("P5 2 2 255\n" + pixels); }), HasSubstr("d: 8-bit PGM, expected 16-bit"));
  EXPECT_THAT(error_of([&] { read("P5 2 3 65535\n" + pixels); }), HasSubstr("d: truncated"));
  EXPECT_THAT(error_of([&] { read("P5 99999 99999 65535\n" + pixels); }), HasSubstr("99999x99999 pixels"));
  EXPECT_THAT(error_of([&] { read("P5 x"); }), HasSubstr("0x0 pixels"));
}

TEST(DepthPicture, ReadsArraysOfNumpy) {
  EXPECT_THAT(values(read(npy<std::uint16_t>("<u2", "1, 3", {0, 7, 5000}), 5000.F)), ElementsAre(0, 1, 1000));
  EXPECT_THAT(values(read(npy<std::uint16_t>(">u2", "3, 1", {0x0100, 0xE803, 0}))), ElementsAre(1, 1000, 0));
  EXPECT_THAT(values(read(npy<std::int32_t>("<i4", "3, 1", {-5, 70000, 12}))), ElementsAre(0, 0, 12));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string metres = npy<float>("<f4", "2, 3, 1", {0.F, nan, 1.2345F, -1.F, 65.6F, 2.F});
  EXPECT_THAT(values(read(metres, 5000.F)), ElementsAre(0, 0, 1235, 0, 0, 2000))
      << "metres, whatever whole numbers are";
  EXPECT_THAT(values(read(npy<double>("<f8", "1, 2", {1000., 5000.}), 1000.F, true)), ElementsAre(1000, 5000));
}

TEST(DepthPicture, RefusesOtherArrays) {
  const std::vector<std::uint16_t> four{1, 2, 3, 4};
  EXPECT_THAT(error_of([&] { read(npy("<u2", "2, 1, 2, 1", four)); }),
              HasSubstr("array of (2, 1, 2, 1), expected rows"));
  EXPECT_THAT(error_of([&] { read(npy("<u2", "2, 2", four, true)); }), HasSubstr("expected rows of columns"));
  EXPECT_THAT(error_of([&] { read(npy("<u2", "2, 3", four)); }),
              HasSubstr("truncated: 8 bytes of pixels, expected 12"));
  EXPECT_THAT(error_of([&] { read(npy("|u1", "2, 2", four)); }), HasSubstr("array of |u1, expected uint16"));
  EXPECT_THAT(error_of([&] { read(npy("|O", "2, 2", four)); }), HasSubstr("array of |O"));
  EXPECT_THAT(error_of([&] { read(npy("<u2", "-2, 2", four)); }), HasSubstr("pixels"));
  EXPECT_THAT(error_of([&] { read("\x93NUMPY\x01"s); }), HasSubstr("truncated"));
  EXPECT_THAT(error_of([&] { read("\x93NUMPY\x02\0\xFF\xFF\xFF\xFF{}"s); }), HasSubstr("truncated"));
}

TEST(DepthPicture, ReadsPfmFromTheLowestRowUp) {
  cv::Mat metres(2, 2, CV_32F);
  metres.at<float>(0, 0) = 1.5F, metres.at<float>(0, 1) = 0.F;
  metres.at<float>(1, 0) = 2.25F, metres.at<float>(1, 1) = std::numeric_limits<float>::infinity();
  std::vector<std::uint8_t> written;
  ASSERT_TRUE(cv::imencode(".pfm", metres, written));
  const std::string bytes(written.begin(), written.end());
  EXPECT_THAT(values(read(bytes)), ElementsAre(1500, 0, 2250, 0));
  EXPECT_THAT(values(read("Pf 1 1 1.0\n\x3F\x80\0\0"s)), ElementsAre(1000)) << "the high byte first";
  EXPECT_THAT(error_of([&] { read(bytes.substr(0, bytes.size() - 1)); }), HasSubstr("d: truncated"));
  EXPECT_THAT(error_of([] { read("Pf\n100000 100000\n-1\n"); }), HasSubstr("pixels"));
  EXPECT_THAT(error_of([] { read("Pf\n2"); }), HasSubstr("d: truncated PFM"));
  EXPECT_THAT(error_of([] { read("PF\n1 1\n-1\n123456789abc"); }), HasSubstr("d: PFM of colours"));
}

TEST(DepthPicture, SaysWhatOtherPicturesAre) {
  EXPECT_THAT(error_of([] { read("\xFF\xD8\xFF\xE0"); }), HasSubstr("d: JPEG, which loses depth"));
  const bool is_read = has_avcodec();
  EXPECT_THAT(error_of([] { read("II*\0\x08\0\0\0"s); }),
              HasSubstr(is_read ? "d: damaged TIFF" : "d: depth of .tif, expected PNG; convert: python3"));
  if (is_read) {
    const std::string floats = "II*\0\x08\0\0\0\1\0\x53\1\3\0\1\0\0\0\3\0\0\0\0\0\0\0"s;
    EXPECT_THAT(error_of([&] { read(floats); }),
                HasSubstr("d: TIFF of floats, which is not read; write metres as .npy"));
    const std::string pages = "MM\0*\0\0\0\x08\0\0\0\0\0\x0E"s;
    EXPECT_THAT(error_of([&] { read(pages); }), HasSubstr("d: TIFF of several pictures"));
  }
  EXPECT_THAT(error_of([] { read("\x76\x2f\x31\x01\x02"); }),
              HasSubstr(is_read ? "d: damaged OpenEXR" : "d: depth of .exr, expected PNG; convert"));
  EXPECT_THAT(error_of([] { read(encode_png(Image<std::uint8_t>(2, 2, 9))); }),
              HasSubstr("d: 8-bit grey PNG, expected 16"));
  EXPECT_THAT(error_of([] { read(encode_png(ColourImage(2, 2))); }), HasSubstr("d: 8-bit colour PNG, expected 16"));
}

TEST(ToMillimetres, RoundsAndDropsValuesThatDoNotFit) {
  const std::string stored = npy<std::uint16_t>("<u2", "1, 5", {0, 7, 8, 5000, 65535});
  EXPECT_THAT(values(read(stored, 5000.F)), ElementsAre(0, 1, 2, 1000, 0)) << "65535 is no reading";
  EXPECT_THAT(values(read(stored, 100.F)), ElementsAre(0, 70, 80, 50000, 0));
}

TEST(DecodeColour, ReadsPpm) {
  const ColourImage colour = decode_colour("P6\n2 1 255\n\x01\x02\x03\x04\x05\x06", "c");
  EXPECT_EQ(colour(1, 0), (Rgb{4, 5, 6}));
  EXPECT_THAT(error_of([] { decode_colour("P6\n2 1 65535\n123456789012", "c"); }), HasSubstr("c: PPM of 16 bits"));
}

}  // namespace
}  // namespace vesalius
