#include "io/recordings/camera_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <type_traits>

#include "io/files/depth_picture.h"
#include "io/files/image_bytes.h"
#include "io/lens/lens.h"
#include "io/recordings/camera_topics.h"
#include "io/recordings/colour_encodings.h"
#include "io/recordings/depth_codecs.h"
#include "io/recordings/foxglove_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/picture_look.h"
#include "vesalius/base/depth_reading.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

constexpr std::string_view kDisparities = "stereo_msgs/DisparityImage", kPoints = "sensor_msgs/PointCloud2",
                           kFoxgloveCalibration = "CameraCalibration",
                           kPacket = "ffmpeg_image_transport_msgs/FFMPEGPacket";

int picture_side(std::uint64_t value, const std::string& name) {
  if (value > static_cast<std::uint64_t>(kMaxPixels)) {
    throw Error(fmt::format("{}: a picture {} pixels long, expected at most {}", name, value, kMaxPixels));
  }
  return int(value);
}

template <std::size_t N>
std::array<double, N> exactly(const std::vector<double>& values) {
  std::array<double, N> all{};
  if (values.size() == N) std::ranges::copy(values, all.begin());
  return all;
}

/// Reads the number that stands `at` bytes behind the beginning of a row.
template <class T>
T value_at(const PictureMessage& picture, int v, std::size_t at) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), picture.data.data() + static_cast<std::size_t>(v) * picture.row_bytes + at, sizeof(T));
  if (picture.big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

/// Makes depth of the numbers of a raw picture, one from the next `step` bytes away.
template <class T, class ToReading>
DepthImage depth_from(const PictureMessage& picture, std::size_t step, std::size_t first, const std::string& name,
                      const ToReading& to_reading) {
  expect_rows(picture, step, name);
  DepthImage depth(picture.width, picture.height);
  for (int v = 0; v < picture.height; ++v) {
    for (int u = 0; u < picture.width; ++u) {
      depth(u, v) = to_reading(value_at<T>(picture, v, static_cast<std::size_t>(u) * step + first));
    }
  }
  return depth;
}

ColourImage colour_of_points(const PictureMessage& picture, const std::string& name) {
  expect_rows(picture, picture.point_bytes, name);
  ColourImage colour(picture.width, picture.height);
  for (int v = 0; v < picture.height; ++v) {
    for (int u = 0; u < picture.width; ++u) {
      const std::size_t at = std::size_t(u) * picture.point_bytes + *picture.rgb;
      colour(u, v) = unpack_rgb(value_at<std::uint32_t>(picture, v, at));
    }
  }
  return colour;
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

/// From Orbbec's SDK 2 on; those of accelerometers have other fields.
bool is_orbbec_profile(const RecordedTopic& topic) {
  return topic.layout == MessageLayout::ros1 && topic.type.ends_with("StreamProfileInfo") &&
         topic.type.find("Imu") == std::string::npos && orbbec_number(topic.name, "/cam/streamProfileType_") != 0;
}

/// Reads an OBStreamProfileInfo after its header.
Calibration parse_orbbec_profile(MessageFields& fields, const RecordedTopic& topic) {
  constexpr std::array kOrbbecModels{
      "", "modified_brown_conrady", "inverse_brown_conrady", "brown_conrady", "rational_polynomial", "kannala_brandt4"};
  constexpr int kPose = 12;
  const auto reals = [&](int count, const char* what) {
    std::vector<double> all(std::size_t(count), 0.0);
    for (double& each : all) each = double(fields.real32(what));
    return all;
  };
  fields.u8("the kind of stream");
  fields.u8("the format");
  reals(kPose, "the pose");
  Calibration calibration;
  calibration.frame = orbbec_frame(orbbec_stream(topic.name));
  calibration.width = fields.u16("the width");
  calibration.height = fields.u16("the height");
  fields.u16("the rate");
  const std::vector<double> k = reals(4, "the intrinsics");
  const std::vector<double> d = reals(8, "the distortion");
  const std::uint8_t model = fields.u8("the distortion model");
  calibration.model = model < kOrbbecModels.size() ? kOrbbecModels[model] : fmt::format("number {}", model);
  const bool is_fisheye = model + 1U == kOrbbecModels.size();
  if (is_fisheye) {
    calibration.distortion.assign(d.begin(), d.begin() + 4);
  } else {
    calibration.distortion = {d[0], d[1], d[6], d[7], d[2], d[3], d[4], d[5]};
  }
  calibration.matrix = {k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1};
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

/// Pictures that are compressed in a message for raw ones, as Orbbec records colour.
bool is_compressed_encoding(std::string_view encoding) {
  return std::ranges::any_of(std::array{"mjpg", "mjpeg", "jpeg", "jpg", "png", "MJPG"},
                             [&](const char* one) { return encoding == one; });
}

/// Returns the name of an encoding as ROS spells it: some write OpenCV's kinds of pixels as "16uc1" or "TYPE_16UC1".
std::string plain_encoding(std::string_view given) {
  constexpr std::string_view kType = "TYPE_";
  if (given.starts_with(kType)) given.remove_prefix(kType.size());
  std::string encoding(given);
  const bool is_of_opencv = encoding.size() > 3 && std::isdigit(static_cast<unsigned char>(encoding.front())) != 0 &&
                            std::tolower(static_cast<unsigned char>(encoding[encoding.size() - 2])) == 'c';
  if (is_of_opencv) std::ranges::transform(encoding, encoding.begin(), [](unsigned char c) { return std::toupper(c); });
  return encoding;
}

/// Returns the bytes from one row to the next; some writers leave them out.
std::uint32_t row_length(std::uint64_t given, const PictureMessage& picture) {
  const bool is_left_out = given == 0 && picture.height > 0;
  return static_cast<std::uint32_t>(is_left_out ? picture.data.size() / std::size_t(picture.height) : given);
}

/// Orbbec's Images have numbers behind the picture. Some have how many bytes there are of a camera's own before it, in
/// the list of the picture's bytes and counted in front of that.
void skip_orbbec_metadata(MessageFields fields, PictureMessage& picture) {
  constexpr std::size_t kBehind = 32, kMostBehind = 64;
  const std::uint32_t own = fields.u32("the length of metadata");
  if (fields.left() < sizeof(std::uint32_t)) return;
  const std::uint32_t all = fields.u32("the length of the picture");
  if (own > all || fields.left() < all + kBehind || fields.left() > all + kMostBehind) return;
  picture.data = fields.take(all, "the picture").substr(own);
}

void parse_image(MessageFields& fields, PictureMessage& picture, const std::string& name, bool is_orbbec) {
  picture.height = picture_side(fields.u32("the height"), name);
  picture.width = picture_side(fields.u32("the width"), name);
  picture.encoding = plain_encoding(fields.text("the encoding"));
  picture.compressed = is_compressed_encoding(picture.encoding);
  picture.big_endian = fields.u8("the byte order") != 0;
  const std::uint32_t row_bytes = fields.u32("the length of a row");
  if (is_orbbec) skip_orbbec_metadata(fields, picture);
  if (picture.data.empty()) picture.data = fields.bytes("the picture");
  picture.row_bytes = row_length(row_bytes, picture);
}

/// stereo_msgs/DisparityImage
void parse_disparities(MessageFields& fields, PictureMessage& picture, const std::string& name) {
  std::string frame_of_picture;
  fields.header(frame_of_picture);
  parse_image(fields, picture, name, false);
  const double focal = fields.real32("the focal length");
  picture.focal_baseline = focal * fields.real32("the baseline");
  if (!(picture.focal_baseline > 0.0)) throw Error(name + ": disparities without a focal length and a baseline");
}

/// sensor_msgs/PointCloud2
void parse_points(MessageFields& fields, PictureMessage& picture, const std::string& name) {
  constexpr std::uint8_t kFloat = 7;
  picture.height = picture_side(fields.u32("the height"), name);
  picture.width = picture_side(fields.u32("the width"), name);
  int found = 0;
  const std::uint32_t count = fields.u32("the number of fields");
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string_view field = fields.text("the name of a field");
    const std::uint32_t offset = fields.u32("the place of a field");
    const bool is_float = fields.u8("the type of a field") == kFloat;
    fields.u32("the length of a field");
    if (field == "rgb" || field == "rgba") picture.rgb = offset;
    const std::size_t axis = std::string_view("xyz").find(field);
    if (field.size() != 1 || axis == std::string_view::npos || !is_float) continue;
    picture.xyz[axis] = offset;
    found |= 1 << axis;
  }
  picture.big_endian = fields.u8("the byte order") != 0;
  const std::uint32_t point_bytes = fields.u32("the length of a point");
  picture.row_bytes = fields.u32("the length of a row");
  picture.data = fields.bytes("the points");
  const std::uint32_t last = std::max(std::ranges::max(picture.xyz), picture.rgb.value_or(0));
  const bool fits = last + std::uint64_t{sizeof(float)} <= point_bytes;
  const bool is_picture = picture.height > 1 && found == 7;
  picture.encoding = is_picture ? "xyz" : picture.height > 1 ? "without x, y, z" : "in no rows";
  if (is_picture && picture.rgb) picture.encoding += " rgb";
  if (is_picture && fits) picture.point_bytes = point_bytes;
}

bool is_foxglove_picture(const RecordedTopic& topic) {
  return is_foxglove(topic, "RawImage") || is_foxglove(topic, "CompressedImage") ||
         is_foxglove(topic, "CompressedVideo");
}

PictureMessage foxglove_picture(const RecordedTopic& topic, std::string_view message, const std::string& name) {
  const FoxgloveMessage fields = read_foxglove(topic, message, name).front();
  PictureMessage picture;
  picture.compressed = !is_foxglove(topic, "RawImage");
  picture.time_ns = static_cast<std::int64_t>(fields.number("timestamp"));
  picture.frame = fields.text("frame_id");
  picture.width = picture_side(fields.number("width"), name);
  picture.height = picture_side(fields.number("height"), name);
  const std::string_view encoding = fields.text(picture.compressed ? "format" : "encoding");
  picture.encoding = picture.compressed ? std::string(encoding) : plain_encoding(encoding);
  picture.data = fields.text("data");
  picture.row_bytes = row_length(fields.number("step"), picture);
  picture.unpacked = fields["data"].owned;
  return picture;
}

Calibration foxglove_calibration(const RecordedTopic& topic, std::string_view message, const std::string& name) {
  const FoxgloveMessage fields = read_foxglove(topic, message, name).front();
  Calibration calibration;
  calibration.frame = fields.text("frame_id");
  calibration.width = picture_side(fields.number("width"), name);
  calibration.height = picture_side(fields.number("height"), name);
  calibration.model = fields.text("distortion_model");
  calibration.distortion = fields.reals("D");
  calibration.matrix = exactly<9>(fields.reals("K"));
  calibration.rotation = exactly<9>(fields.reals("R"));
  calibration.projection = exactly<12>(fields.reals("P"));
  return calibration;
}

/// ffmpeg_image_transport_msgs/FFMPEGPacket
void parse_packet(MessageFields& fields, PictureMessage& picture, const std::string& name) {
  picture.width = picture_side(fields.u32("the width"), name);
  picture.height = picture_side(fields.u32("the height"), name);
  picture.encoding = fields.text("the encoding");
  fields.u64("the time of the packet");
  fields.u8("the flags");
  fields.u8("the byte order");
  picture.data = fields.bytes("the packet");
}

template <class T>
std::string_view bytes_of(const Image<T>& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(T)};
}

}  // namespace

bool is_picture(const RecordedTopic& topic) {
  if (is_foxglove_picture(topic)) return true;
  return is_ros(topic) && (topic.type == "sensor_msgs/Image" || topic.type == "sensor_msgs/CompressedImage" ||
                           topic.type == kDisparities || topic.type == kPoints || topic.type == kPacket);
}

bool is_calibration(const RecordedTopic& topic) {
  if (is_realsense_text(topic) || is_orbbec_profile(topic)) return true;
  return is_foxglove(topic, kFoxgloveCalibration) || (is_ros(topic) && topic.type == "sensor_msgs/CameraInfo");
}

PictureMessage parse_picture(const RecordedTopic& topic, std::string_view message, const std::string& name) {
  if (is_foxglove_picture(topic)) return foxglove_picture(topic, message, name);
  PictureMessage picture;
  picture.compressed = topic.type == kPacket || topic.type.ends_with("CompressedImage");
  MessageFields fields(message, topic.layout, name);
  picture.time_ns = fields.header(picture.frame);
  if (std::string stream = realsense_stream(topic.name); !stream.empty()) picture.frame = std::move(stream);
  const int orbbec = orbbec_stream(topic.name);
  if (orbbec != 0) picture.frame = orbbec_frame(orbbec);
  if (topic.type == kDisparities) {
    parse_disparities(fields, picture, name);
  } else if (topic.type == kPoints) {
    parse_points(fields, picture, name);
  } else if (topic.type == kPacket) {
    parse_packet(fields, picture, name);
  } else if (picture.compressed) {
    picture.encoding = fields.text("the format");
    picture.data = fields.bytes("the picture");
  } else {
    parse_image(fields, picture, name, orbbec != 0);
  }
  return picture;
}

Calibration parse_calibration(const RecordedTopic& topic, std::string_view message, const std::string& name) {
  Calibration calibration;
  if (is_foxglove(topic, kFoxgloveCalibration)) return foxglove_calibration(topic, message, name);
  MessageFields fields(message, topic.layout, name);
  if (is_realsense_text(topic)) {
    calibration = parse_realsense_text(fields.text("the calibration"), name);
    calibration.frame = realsense_stream(topic.name);
    return calibration;
  }
  fields.header(calibration.frame);
  if (is_orbbec_profile(topic)) return parse_orbbec_profile(fields, topic);
  if (std::string stream = realsense_stream(topic.name); !stream.empty()) calibration.frame = std::move(stream);
  calibration.height = picture_side(fields.u32("the height"), name);
  calibration.width = picture_side(fields.u32("the width"), name);
  calibration.model = fields.text("the distortion model");
  calibration.distortion = fields.list64("the distortion");
  calibration.matrix = exactly<9>(fields.reals64(9, "the camera matrix"));
  calibration.rotation = exactly<9>(fields.reals64(9, "the rotation"));
  calibration.projection = exactly<12>(fields.reals64(12, "the projection"));
  const auto whole = [&](const char* what) { return int(std::min<std::int64_t>(fields.u32(what), kMaxPixels)); };
  calibration.binning_x = std::max(1, whole("the binning"));
  calibration.binning_y = std::max(1, whole("the binning"));
  calibration.roi_x = whole("the part of the picture");
  calibration.roi_y = whole("the part of the picture");
  calibration.roi_height = whole("the part of the picture");
  calibration.roi_width = whole("the part of the picture");
  return calibration;
}

std::optional<Calibration> scaled_to(const Calibration& calibration, int width, int height) {
  Calibration c = calibration;
  if (c.width == width && c.height == height) return c;
  const bool is_part = c.roi_width > 0 && c.roi_height > 0;
  const std::int64_t part_width = is_part ? c.roi_width : c.width, part_height = is_part ? c.roi_height : c.height;
  double x = c.binning_x, y = c.binning_y;
  if (part_width / c.binning_x != width || part_height / c.binning_y != height) {
    const std::optional<double> by = whole_ratio(part_width, part_height, width, height);
    if (!by) return std::nullopt;
    x = y = *by;
  }
  // A pixel's centre has whole numbers, so that the picture begins half a pixel before 0.
  const auto centre = [](double at, int first, double by) { return (at - first + 0.5) / by - 0.5; };
  c.matrix[0] /= x;
  c.matrix[4] /= y;
  c.matrix[2] = centre(c.matrix[2], c.roi_x, x);
  c.matrix[5] = centre(c.matrix[5], c.roi_y, y);
  c.projection[0] /= x;
  c.projection[3] /= x;
  c.projection[5] /= y;
  c.projection[7] /= y;
  c.projection[2] = centre(c.projection[2], c.roi_x, x);
  c.projection[6] = centre(c.projection[6], c.roi_y, y);
  c.width = width;
  c.height = height;
  return c;
}

bool is_depth(const PictureMessage& picture) { return look_at(picture).is_depth(); }

DepthImage depth_of(const PictureMessage& given, const StoredDepth& stored, const std::string& name) {
  const std::string& encoding = given.encoding;
  const double to_mm = 1e3 / double(stored.units_per_m), float_to_mm = 1e3 / double(stored.float_units_per_m);
  const auto whole = [&](auto value) {
    if constexpr (std::is_unsigned_v<decltype(value)>) {
      value = restored(value, stored.bits);
      if (value == kNoReading) value = 0;
    }
    if (to_mm == 1.0 && sizeof(value) <= sizeof(std::uint16_t)) {
      return static_cast<std::uint16_t>(std::max<int>(value, 0));
    }
    return depth_reading_of_mm(value * to_mm);
  };
  const auto real = [&](auto value) { return depth_reading_of_mm(float_to_mm * double(value)); };
  if (given.compressed) {
    const bool is_packed = encoding.find("compressedDepth") != std::string::npos;
    DepthPicture picture;
    if (is_packed) {
      picture.whole = unpack_compressed_depth(given.data, encoding, name);
    } else {
      picture = decode_depth(given.data, name);
    }
    if (!picture.real.empty()) {
      Image<std::uint16_t> depth(picture.width(), picture.height());
      std::ranges::transform(picture.real, depth.begin(), real);
      return depth;
    }
    Image<std::uint16_t> depth = std::move(picture.whole);
    if (!encoding.starts_with("32FC1")) std::ranges::transform(depth, depth.begin(), whole);
    return depth;
  }
  PictureMessage picture = given;
  const bool is_real = picture.point_bytes > 0 || picture.focal_baseline > 0.0 || encoding.ends_with("FC1");
  if (is_real && stored.bits == DepthBits::swapped) picture.big_endian = !picture.big_endian;
  if (picture.point_bytes > 0) return depth_from<float>(picture, picture.point_bytes, picture.xyz[2], name, real);
  if (picture.focal_baseline > 0.0) {
    return depth_from<float>(picture, sizeof(float), 0, name, [&](float disparity) {
      return depth_reading_of_mm(disparity > 0.F ? 1e3 * picture.focal_baseline / double(disparity) : 0.0);
    });
  }
  if (encoding == "32FC1") return depth_from<float>(picture, sizeof(float), 0, name, real);
  if (encoding == "64FC1") return depth_from<double>(picture, sizeof(double), 0, name, real);
  if (encoding == "16SC1") return depth_from<std::int16_t>(picture, sizeof(std::int16_t), 0, name, whole);
  if (encoding == "32SC1") return depth_from<std::int32_t>(picture, sizeof(std::int32_t), 0, name, whole);
  return depth_from<std::uint16_t>(picture, sizeof(std::uint16_t), 0, name, whole);
}

Image<Eigen::Vector3f> points_of(const PictureMessage& picture, const std::string& name) {
  if (picture.point_bytes == 0) throw Error(name + ": no points in rows with x, y and z");
  expect_rows(picture, picture.point_bytes, name);
  Image<Eigen::Vector3f> points(picture.width, picture.height, Eigen::Vector3f::Zero());
  for (int v = 0; v < picture.height; ++v) {
    for (int u = 0; u < picture.width; ++u) {
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t at = std::size_t(u) * picture.point_bytes + picture.xyz[std::size_t(axis)];
        points(u, v)[axis] = value_at<float>(picture, v, at);
      }
    }
  }
  return points;
}

ColourImage colour_of(const PictureMessage& picture, const std::string& name) {
  if (picture.point_bytes > 0 && picture.rgb) return colour_of_points(picture, name);
  return picture.compressed ? decode_colour(picture.data, name) : decode_raw_colour(picture, name);
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
