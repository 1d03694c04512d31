#include "io/files/image_file.h"

#include <fmt/format.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "io/files/atomic_file.h"
#include "io/files/image_bytes.h"
#include "io/files/read_file.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

cv::Mat decode(std::string_view bytes, int flags, int type, const std::string& name) {
  cv::Mat decoded;
  try {
    // imdecode only reads, but takes a Mat, which has no const form.
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    decoded = cv::imdecode(raw, flags);
  } catch (const cv::Exception&) {
    decoded.release();
  }
  if (decoded.empty() || decoded.type() != type) throw Error(name + ": damaged picture: it cannot be decoded");
  return decoded;
}

template <class T>
Image<T> decode_grey_png(std::string_view bytes, const std::string& name, const char* expected) {
  const PngBytes png = check_png(bytes, name);
  if (png.colour_type != 0 || png.bit_depth != 8 * static_cast<int>(sizeof(T))) {
    const char* kind = png.colour_type == 0 ? "grey" : png.colour_type == 4 ? "grey and alpha" : "colour";
    throw Error(fmt::format("{}: {}-bit {} PNG, expected {}", name, png.bit_depth, kind, expected));
  }
  const cv::Mat mat = decode(png.pixels, cv::IMREAD_UNCHANGED, sizeof(T) == 2 ? CV_16UC1 : CV_8UC1, name);
  Image<T> image(mat.cols, mat.rows);
  for (int v = 0; v < mat.rows; ++v) std::memcpy(image.row(v), mat.ptr(v), sizeof(T) * mat.cols);
  return image;
}

std::string encode(const cv::Mat& mat, const char* extension = ".png", const std::vector<int>& parameters = {}) {
  std::vector<unsigned char> bytes;
  try {
    if (mat.empty() || !cv::imencode(extension, mat, bytes, parameters)) {
      throw Error(fmt::format("picture cannot be encoded as {}", extension));
    }
  } catch (const cv::Exception& e) {
    throw Error(fmt::format("picture cannot be encoded as {}: {}", extension, e.err));
  }
  return {bytes.begin(), bytes.end()};
}

cv::Mat bgr_mat(const ColourImage& image) {
  cv::Mat mat(image.height(), image.width(), CV_8UC3);
  for (int v = 0; v < image.height(); ++v) {
    auto* bgr = mat.ptr<cv::Vec3b>(v);
    const Rgb* rgb = image.row(v);
    for (int u = 0; u < image.width(); ++u) bgr[u] = {rgb[u].b, rgb[u].g, rgb[u].r};
  }
  return mat;
}

template <class T>
std::string encode_grey(const Image<T>& image, int type) {
  return encode(cv::Mat(image.height(), image.width(), type, const_cast<T*>(image.data())));
}

template <class T>
void write(const Image<T>& image, const std::string& path) {
  write_file_atomically(path, with_context(path, [&] { return encode_png(image); }));
}

}  // namespace

Image<std::uint16_t> decode_depth_png(std::string_view bytes, const std::string& name) {
  return decode_grey_png<std::uint16_t>(bytes, name, "16-bit grey (depth, 0 = no reading)");
}

Image<std::uint16_t> read_png16(const std::string& path) { return decode_depth_png(read_file(path), path); }

Image<std::uint8_t> read_png8(const std::string& path) {
  return decode_grey_png<std::uint8_t>(read_file(path), path, "8-bit grey");
}

ColourImage decode_colour(std::string_view bytes, const std::string& name) {
  constexpr int kFlags = cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;
  cv::Mat mat;
  if (is_png(bytes)) {
    mat = decode(check_png(bytes, name).pixels, kFlags, CV_8UC3, name);
  } else if (is_jpeg(bytes)) {
    check_jpeg(bytes, name);
    mat = decode(bytes, kFlags, CV_8UC3, name);
  } else {
    throw Error(name + (bytes.empty() ? ": empty file" : ": unknown kind of picture") + ", expected a PNG or JPEG");
  }
  ColourImage image(mat.cols, mat.rows);
  for (int v = 0; v < mat.rows; ++v) {
    const cv::Vec3b* bgr = mat.ptr<cv::Vec3b>(v);
    Rgb* rgb = image.row(v);
    for (int u = 0; u < mat.cols; ++u) rgb[u] = {bgr[u][2], bgr[u][1], bgr[u][0]};
  }
  return image;
}

ColourImage read_colour(const std::string& path) { return decode_colour(read_file(path), path); }

std::string encode_png(const Image<std::uint16_t>& image) { return encode_grey(image, CV_16UC1); }

std::string encode_png(const Image<std::uint8_t>& image) { return encode_grey(image, CV_8UC1); }

std::string encode_png(const ColourImage& image) { return encode(bgr_mat(image)); }

std::string encode_jpeg(const ColourImage& image, int quality) {
  return encode(bgr_mat(image), ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

void write_png(const Image<std::uint16_t>& image, const std::string& path) { write(image, path); }
void write_png(const Image<std::uint8_t>& image, const std::string& path) { write(image, path); }
void write_png(const ColourImage& image, const std::string& path) { write(image, path); }

}  // namespace vesalius
