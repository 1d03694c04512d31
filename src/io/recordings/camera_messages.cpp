#include "io/recordings/camera_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "io/files/image_bytes.h"
#include "io/recordings/depth_codecs.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/realsense_topics.h"
#include "vesalius/base/depth_reading.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

/// Encodings of colour and where red, green and blue stand in a pixel.
struct ColourEncoding {
  std::string_view name;
  int bytes, r, g, b;
};
constexpr std::array<ColourEncoding, 7> kColourEncodings{{{"rgb8", 3, 0, 1, 2},
                                                          {"bgr8", 3, 2, 1, 0},
                                                          {"8UC3", 3, 2, 1, 0},
                                                          {"rgba8", 4, 0, 1, 2},
                                                          {"bgra8", 4, 2, 1, 0},
                                                          {"mono8", 1, 0, 0, 0},
                                                          {"8UC1", 1, 0, 0, 0}}};

int picture_side(std::uint64_t value, const std::string& name) {
  if (value > static_cast<std::uint64_t>(kMaxPixels)) {
    throw Error(fmt::format("{}: a picture {} pixels long, expected at most {}", name, value, kMaxPixels));
  }
  return int(value);
}

/// google.protobuf.Timestamp
std::int64_t protobuf_time(std::string_view bytes, const std::string& name) {
  const ProtobufFields time = parse_protobuf(bytes, name);
  return static_cast<std::int64_t>(time.number(1) * kNanoseconds + time.number(2));
}

template <std::size_t N>
std::array<double, N> exactly(const std::vector<double>& values) {
  std::array<double, N> all{};
  if (values.size() == N) std::ranges::copy(values, all.begin());
  return all;
}

/// Throws Error unless all rows of the picture are there.
void expect_rows(const PictureMessage& picture, std::size_t pixel_bytes, const std::string& name) {
  const auto width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
  if (width == 0 || height == 0 || width * height > kMaxPixels) {
    throw Error(fmt::format("{}: a picture of {}x{}, expected at most {} pixels", name, width, height, kMaxPixels));
  }
  if (picture.row_bytes < width * pixel_bytes || picture.data.size() / picture.row_bytes < height) {
    throw Error(fmt::format("{}: a picture of {}x{} {} with {} bytes, {} to a row", name, width, height,
                            picture.encoding, picture.data.size(), picture.row_bytes));
  }
}

/// Reads a number of a raw picture.
template <class T>
T value_at(const PictureMessage& picture, int u, int v) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), picture.data.data() + static_cast<std::size_t>(v) * picture.row_bytes + u * sizeof(T),
              sizeof(T));
  if (picture.big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

/// From librealsense 2.56 on, what the library itself states: its messages of sensor_msgs call every model plumb_bob.
bool is_realsense_text(const RecordedTopic& topic) {
  return topic.type == "std_msgs/String" && topic.layout == MessageLayout::cdr &&
         topic.name == realsense_stream(topic.name) + "/camera_info";
}

Calibration parse_realsense_text(std::string_view text, const std::string& name) {
  const auto number = [&](const char* key) {
    const std::vector<double> numbers = realsense_numbers(realsense_value(text, key));
    return numbers.empty() ? 0.0 : numbers.front();
  };
  const auto whole = [&](const char* key) {
    const double value = number(key);
    return value >= 0.0 && value <= double(kMaxPixels) ? picture_side(static_cast<std::uint64_t>(value), name) : 0;
  };
  Calibration calibration;
  calibration.width = whole("width");
  calibration.height = whole("height");
  calibration.model = realsense_value(text, "model");
  calibration.distortion = realsense_numbers(realsense_value(text, "coeffs"));
  calibration.matrix = {number("fx"), 0, number("ppx"), 0, number("fy"), number("ppy"), 0, 0, 1};
  return calibration;
}

std::string image_message(std::string_view encoding, int width, int height, int pixel_bytes, std::string_view data,
                          std::int64_t time_ns, std::string_view frame) {
  PictureMessage picture;
  picture.time_ns = time_ns;
  picture.frame = frame;
  picture.width = width;
  picture.height = height;
  picture.encoding = encoding;
  picture.row_bytes = static_cast<std::uint32_t>(width * pixel_bytes);
  picture.data = data;
  return picture_message(picture);
}

/// Returns the colour of luminance and chrominance as television has them (BT.601, 16 to 235), in 256ths.
Rgb from_yuv(int y, int u, int v) {
  constexpr int kScale = 298, kRound = 128, kShift = 8;
  const int c = kScale * (y - 16) + kRound, d = u - 128, e = v - 128;
  const auto byte = [](int value) { return static_cast<std::uint8_t>(std::clamp(value >> kShift, 0, 255)); };
  return {byte(c + 409 * e), byte(c - 100 * d - 208 * e), byte(c + 516 * d)};
}

/// Two pixels share their chrominance: Y U Y V.
ColourImage from_yuy2(const PictureMessage& picture, const std::string& name) {
  constexpr std::size_t kPixelBytes = 2;
  expect_rows(picture, kPixelBytes, name);
  if (picture.width % 2 != 0) {
    throw Error(fmt::format("{}: yuv422_yuy2 of {} columns, expected an even number", name, picture.width));
  }
  ColourImage colour(picture.width, picture.height);
  for (int v = 0; v < picture.height; ++v) {
    const auto* row =
        reinterpret_cast<const std::uint8_t*>(picture.data.data()) + static_cast<std::size_t>(v) * picture.row_bytes;
    for (int u = 0; u < picture.width; ++u) {
      const std::uint8_t* pair = row + 4 * (u / 2);
      colour(u, v) = from_yuv(row[2 * u], pair[1], pair[3]);
    }
  }
  return colour;
}

/// Luminance of all pixels, then chrominance of each four, U V.
ColourImage from_nv12(const PictureMessage& picture, const std::string& name) {
  expect_rows(picture, 1, name);
  const auto row_bytes = static_cast<std::size_t>(picture.row_bytes);
  const auto height = static_cast<std::size_t>(picture.height);
  if (picture.width % 2 != 0 || picture.height % 2 != 0 || picture.data.size() < row_bytes * (height + height / 2)) {
    throw Error(fmt::format("{}: nv12 of {}x{} with {} bytes, expected even sides and {} bytes", name, picture.width,
                            picture.height, picture.data.size(), row_bytes * (height + height / 2)));
  }
  ColourImage colour(picture.width, picture.height);
  const auto* luminance = reinterpret_cast<const std::uint8_t*>(picture.data.data());
  const std::uint8_t* chrominance = luminance + row_bytes * height;
  for (int v = 0; v < picture.height; ++v) {
    const std::uint8_t* y = luminance + row_bytes * static_cast<std::size_t>(v);
    const std::uint8_t* uv = chrominance + row_bytes * static_cast<std::size_t>(v / 2);
    for (int u = 0; u < picture.width; ++u) colour(u, v) = from_yuv(y[u], uv[u / 2 * 2], uv[u / 2 * 2 + 1]);
  }
  return colour;
}

template <class T>
std::string_view bytes_of(const Image<T>& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(T)};
}

}  // namespace

bool is_picture(const RecordedTopic& topic) {
  if (is_ros(topic)) return topic.type == "sensor_msgs/Image" || topic.type == "sensor_msgs/CompressedImage";
  return topic.layout == MessageLayout::protobuf &&
         (topic.type == "foxglove.RawImage" || topic.type == "foxglove.CompressedImage");
}

bool is_calibration(const RecordedTopic& topic) {
  if (is_realsense_text(topic)) return true;
  if (is_ros(topic)) return topic.type == "sensor_msgs/CameraInfo";
  return topic.layout == MessageLayout::protobuf && topic.type == "foxglove.CameraCalibration";
}

PictureMessage parse_picture(const RecordedTopic& topic, std::string_view message, const std::string& name) {
  PictureMessage picture;
  picture.compressed = topic.type.ends_with("CompressedImage");
  if (topic.layout == MessageLayout::protobuf) {
    const ProtobufFields fields = parse_protobuf(message, name);
    picture.time_ns = protobuf_time(fields.text(1), name);
    if (picture.compressed) {
      picture.frame = fields.text(4);
      picture.encoding = fields.text(3);
      picture.data = fields.text(2);
    } else {
      picture.frame = fields.text(7);
      picture.width = picture_side(fields.number(2), name);
      picture.height = picture_side(fields.number(3), name);
      picture.encoding = fields.text(4);
      picture.row_bytes = static_cast<std::uint32_t>(fields.number(5));
      picture.data = fields.text(6);
    }
    return picture;
  }
  MessageFields fields(message, topic.layout, name);
  picture.time_ns = fields.header(picture.frame);
  if (std::string stream = realsense_stream(topic.name); !stream.empty()) picture.frame = std::move(stream);
  if (picture.compressed) {
    picture.encoding = fields.text("the format");
  } else {
    picture.height = picture_side(fields.u32("the height"), name);
    picture.width = picture_side(fields.u32("the width"), name);
    picture.encoding = fields.text("the encoding");
    picture.big_endian = fields.u8("the byte order") != 0;
    picture.row_bytes = fields.u32("the length of a row");
  }
  picture.data = fields.bytes("the picture");
  return picture;
}

Calibration parse_calibration(const RecordedTopic& topic, std::string_view message, const std::string& name) {
  Calibration calibration;
  if (topic.layout == MessageLayout::protobuf) {
    const ProtobufFields fields = parse_protobuf(message, name);
    calibration.frame = fields.text(9);
    calibration.width = picture_side(fields.number(2), name);
    calibration.height = picture_side(fields.number(3), name);
    calibration.model = fields.text(4);
    calibration.distortion = fields.list64(5);
    calibration.matrix = exactly<9>(fields.list64(6));
    calibration.rotation = exactly<9>(fields.list64(7));
    calibration.projection = exactly<12>(fields.list64(8));
    return calibration;
  }
  MessageFields fields(message, topic.layout, name);
  if (is_realsense_text(topic)) {
    calibration = parse_realsense_text(fields.text("the calibration"), name);
    calibration.frame = realsense_stream(topic.name);
    return calibration;
  }
  fields.header(calibration.frame);
  if (std::string stream = realsense_stream(topic.name); !stream.empty()) calibration.frame = std::move(stream);
  calibration.height = picture_side(fields.u32("the height"), name);
  calibration.width = picture_side(fields.u32("the width"), name);
  calibration.model = fields.text("the distortion model");
  calibration.distortion = fields.list64("the distortion");
  calibration.matrix = exactly<9>(fields.reals64(9, "the camera matrix"));
  calibration.rotation = exactly<9>(fields.reals64(9, "the rotation"));
  calibration.projection = exactly<12>(fields.reals64(12, "the projection"));
  return calibration;
}

bool is_depth(const PictureMessage& picture) {
  if (picture.compressed) return picture.encoding.find("compressedDepth") != std::string::npos;
  return picture.encoding == "16UC1" || picture.encoding == "mono16" || picture.encoding == "32FC1";
}

DepthImage depth_of(const PictureMessage& given, const StoredDepth& stored, const std::string& name) {
  const bool is_float = given.encoding.starts_with("32FC1");
  const double to_mm = 1e3 / double(is_float ? stored.float_units_per_m : stored.units_per_m);
  const auto in_mm = [&](std::uint16_t value) { return to_mm == 1.0 ? value : depth_reading_of_mm(value * to_mm); };
  if (given.compressed) {
    Image<std::uint16_t> depth = unpack_compressed_depth(given.data, given.encoding, name);
    if (is_float) return depth;
    restore(depth, stored.bits);
    std::ranges::transform(depth, depth.begin(), in_mm);
    return depth;
  }
  PictureMessage picture = given;
  if (is_float && stored.bits == DepthBits::swapped) picture.big_endian = !picture.big_endian;
  expect_rows(picture, is_float ? sizeof(float) : sizeof(std::uint16_t), name);
  DepthImage depth(picture.width, picture.height);
  for (int v = 0; v < picture.height; ++v) {
    for (int u = 0; u < picture.width; ++u) {
      if (is_float) {
        depth(u, v) = depth_reading_of_mm(to_mm * double(value_at<float>(picture, u, v)));
      } else {
        depth(u, v) = in_mm(restored(value_at<std::uint16_t>(picture, u, v), stored.bits));
      }
    }
  }
  return depth;
}

ColourImage colour_of(const PictureMessage& picture, const std::string& name) {
  if (picture.compressed) return decode_colour(picture.data, name);
  if (picture.encoding == "yuv422_yuy2") return from_yuy2(picture, name);
  if (picture.encoding == "nv12") return from_nv12(picture, name);
  const auto found = std::ranges::find(kColourEncodings, picture.encoding, &ColourEncoding::name);
  if (found == kColourEncodings.end()) {
    throw Error(
        fmt::format("{}: colour encoded as \"{}\", expected rgb8, bgr8, rgba8, bgra8, mono8, yuv422_yuy2 or nv12", name,
                    picture.encoding));
  }
  expect_rows(picture, static_cast<std::size_t>(found->bytes), name);
  ColourImage colour(picture.width, picture.height);
  for (int v = 0; v < picture.height; ++v) {
    const auto* of =
        reinterpret_cast<const std::uint8_t*>(picture.data.data()) + static_cast<std::size_t>(v) * picture.row_bytes;
    for (int u = 0; u < picture.width; ++u, of += found->bytes) {
      colour(u, v) = {of[found->r], of[found->g], of[found->b]};
    }
  }
  return colour;
}

std::string depth_message(const DepthImage& depth, std::int64_t time_ns, std::string_view frame) {
  static_assert(std::endian::native == std::endian::little);
  return image_message("16UC1", depth.width(), depth.height(), 2, bytes_of(depth), time_ns, frame);
}

std::string colour_message(const ColourImage& colour, std::int64_t time_ns, std::string_view frame) {
  return image_message("rgb8", colour.width(), colour.height(), 3, bytes_of(colour), time_ns, frame);
}

std::string grey_message(const Image<std::uint8_t>& grey, std::int64_t time_ns, std::string_view frame) {
  return image_message("mono8", grey.width(), grey.height(), 1, bytes_of(grey), time_ns, frame);
}

std::string picture_message(const PictureMessage& picture) {
  CdrWriter out;
  out.header(picture.time_ns, picture.frame);
  if (picture.compressed) {
    out.text(picture.encoding);
  } else {
    out.u32(static_cast<std::uint32_t>(picture.height));
    out.u32(static_cast<std::uint32_t>(picture.width));
    out.text(picture.encoding);
    out.u8(picture.big_endian ? 1 : 0);
    out.u32(picture.row_bytes);
  }
  out.bytes(picture.data);
  return out.message();
}

std::string calibration_message(const Calibration& calibration, std::int64_t time_ns) {
  CdrWriter out;
  out.header(time_ns, calibration.frame);
  out.u32(static_cast<std::uint32_t>(calibration.height));
  out.u32(static_cast<std::uint32_t>(calibration.width));
  out.text(calibration.model);
  out.u32(static_cast<std::uint32_t>(calibration.distortion.size()));
  for (const double k : calibration.distortion) out.real64(k);
  for (const double k : calibration.matrix) out.real64(k);
  for (const double r : calibration.rotation) out.real64(r);
  for (const double p : calibration.projection) out.real64(p);
  out.u32(0);  // no binning
  out.u32(0);
  for (int i = 0; i < 4; ++i) out.u32(0);  // the whole picture
  out.u8(0);
  return out.message();
}

std::string calibration_message(const Camera& camera, std::int64_t time_ns, std::string_view frame) {
  constexpr std::size_t kCoefficients = 5;
  const double fx = camera.fx, fy = camera.fy, cx = camera.cx, cy = camera.cy;
  Calibration calibration;
  calibration.frame = frame;
  calibration.width = camera.width;
  calibration.height = camera.height;
  calibration.model = "plumb_bob";
  calibration.distortion.assign(kCoefficients, 0.0);
  calibration.matrix = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  calibration.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  calibration.projection = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
  return calibration_message(calibration, time_ns);
}

}  // namespace vesalius
