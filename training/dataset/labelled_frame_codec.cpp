#include "dataset/labelled_frame_codec.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "io/files/image_bytes.h"
#include "io/files/packed.h"

namespace vesalius {
namespace {

// Bits of a frame's flags.
constexpr std::uint8_t kHasColour = 1;
constexpr std::uint8_t kHasTime = 2;
constexpr std::uint8_t kHasUp = 4;
constexpr std::uint8_t kHasPostures = 8;
constexpr std::uint8_t kHasHeight = 16;
constexpr std::uint8_t kHasPose = 32;
constexpr int kAllFlags = kHasColour | kHasTime | kHasUp | kHasPostures | kHasHeight | kHasPose;
constexpr std::size_t kMaxName = 255;

void write_camera(ByteWriter& out, const Camera& camera) {
  out.number(static_cast<std::uint32_t>(camera.width));
  out.number(static_cast<std::uint32_t>(camera.height));
  for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) out.real(value);
}

Camera read_camera(ByteReader& in) {
  Camera camera;
  const auto width = in.number<std::uint32_t>("camera");
  const auto height = in.number<std::uint32_t>("camera");
  const bool usable = width > 0 && height > 0 && width <= kMaxPixels && height <= kMaxPixels &&
                      std::int64_t{width} * std::int64_t{height} <= kMaxPixels;
  if (!usable) in.fail(fmt::format("picture of {}x{}, expected 1 to {} pixels", width, height, kMaxPixels));
  camera.width = int(width);
  camera.height = int(height);
  for (float* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value = in.real32("camera");
  return camera;
}

void write_points(ByteWriter& out, const std::vector<Eigen::Vector3f>& points) {
  for (const Eigen::Vector3f& p : points) {
    for (int axis = 0; axis < 3; ++axis) out.real(p[axis]);
  }
}

std::vector<Eigen::Vector3f> read_points(ByteReader& in, std::size_t count, const char* what) {
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = in.real32(what);
    const float y = in.real32(what);
    points.emplace_back(x, y, in.real32(what));
  }
  return points;
}

void write_people(ByteWriter& out, const LabelledFrame& labelled) {
  out.number(static_cast<std::uint8_t>(labelled.parts.size()));
  for (const auto& parts : labelled.parts) write_points(out, parts);
  out.number(static_cast<std::uint8_t>(labelled.joints.empty() ? 0 : labelled.joints[0].size()));
  for (const auto& joints : labelled.joints) write_points(out, joints);
}

void read_people(ByteReader& in, int part_count, LabelledFrame& labelled) {
  const auto people = in.number<std::uint8_t>("people");
  for (int i = 0; i < people; ++i) {
    labelled.parts.push_back(read_points(in, part_count, "part centre"));
  }
  const auto joints = in.number<std::uint8_t>("joints");
  for (int i = 0; joints > 0 && i < people; ++i) labelled.joints.push_back(read_points(in, joints, "joint"));
}

int flags_of(const LabelledFrame& labelled) {
  const Frame& picture = labelled.frame;
  return (picture.colour.empty() ? 0 : kHasColour) | (picture.time_s ? kHasTime : 0) | (labelled.up ? kHasUp : 0) |
         (labelled.postures.empty() ? 0 : kHasPostures) | (labelled.camera_height_m ? kHasHeight : 0) |
         (labelled.world_from_camera ? kHasPose : 0);
}

void write_circumstances(ByteWriter& out, const LabelledFrame& labelled) {
  if (labelled.up) write_points(out, {*labelled.up});
  for (const std::string& posture : labelled.postures) out.text(posture);
  if (labelled.camera_height_m) out.real(*labelled.camera_height_m);
  if (!labelled.world_from_camera) return;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out.real(labelled.world_from_camera->matrix()(row, column));
  }
}

Eigen::Isometry3f read_pose(ByteReader& in) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = in.real32("camera's pose");
  }
  return pose;
}

void read_circumstances(ByteReader& in, int flags, LabelledFrame& labelled) {
  if ((flags & kHasUp) != 0) labelled.up = read_points(in, 1, "upward direction").front();
  const std::size_t postures = (flags & kHasPostures) != 0 ? labelled.parts.size() : 0;
  for (std::size_t i = 0; i < postures; ++i) labelled.postures.emplace_back(in.text("posture"));
  if ((flags & kHasHeight) != 0) labelled.camera_height_m = in.real32("camera's height");
  if ((flags & kHasPose) != 0) labelled.world_from_camera = read_pose(in);
}

/// Returns the first value that is neither background nor below `count`. The loop does not stop early, so that the
/// compiler can vectorise it; most often there is no such value.
std::optional<std::uint8_t> first_beyond(const Image<std::uint8_t>& plane, std::size_t count) {
  const auto limit = static_cast<std::uint8_t>(std::min<std::size_t>(count, kBackground));
  const auto beyond = [limit](std::uint8_t value) { return value >= limit && value != kBackground; };
  std::uint8_t any = 0;
  for (const std::uint8_t value : plane) any |= static_cast<std::uint8_t>(beyond(value));
  if (any == 0) return std::nullopt;
  return *std::find_if(plane.begin(), plane.end(), beyond);
}

void check_joints(const LabelledFrame& labelled) {
  if (labelled.joints.empty()) return;
  if (labelled.joints.size() != labelled.parts.size()) {
    throw Error(fmt::format("joints of {} people, expected {} or none", labelled.joints.size(), labelled.parts.size()));
  }
  const std::size_t count = labelled.joints[0].size();
  if (count == 0 || count > kMostJoints) throw Error(fmt::format("{} joints, expected 1 to {}", count, kMostJoints));
  for (const auto& joints : labelled.joints) {
    if (joints.size() != count) throw Error(fmt::format("person with {} joints, expected {}", joints.size(), count));
    for (const Eigen::Vector3f& p : joints) {
      if (!p.allFinite()) throw Error("joint is not finite");
    }
  }
}

void check_pose(const Eigen::Isometry3f& pose) {
  const Eigen::Matrix3f turn = pose.linear();
  const bool rigid = (turn * turn.transpose()).isApprox(Eigen::Matrix3f::Identity(), 1e-3F) && turn.determinant() > 0.F;
  if (!rigid || !pose.translation().allFinite()) throw Error("camera's pose is no turn and finite place");
}

void check_circumstances(const LabelledFrame& labelled) {
  if (labelled.up && !(std::abs(labelled.up->norm() - 1.F) <= 1e-3F)) {
    throw Error("upward direction is not of unit length");
  }
  if (labelled.camera_height_m && !std::isfinite(*labelled.camera_height_m)) {
    throw Error("camera's height is not finite");
  }
  if (labelled.world_from_camera) check_pose(*labelled.world_from_camera);
  const std::vector<std::string>& postures = labelled.postures;
  if (!postures.empty() && postures.size() != labelled.parts.size()) {
    throw Error(fmt::format("postures of {} people, expected {} or none", postures.size(), labelled.parts.size()));
  }
  for (const std::string& posture : postures) {
    if (posture.size() > kMaxName) throw Error(fmt::format("posture of more than {} bytes", kMaxName));
  }
}

constexpr int kLevel = 1;  // higher levels save less than 3 % of depth and take several times as long
constexpr std::size_t kValues = 65536;
constexpr std::size_t kWidestNumber = 3;  // bytes of a varint of at most 2 x 65536
constexpr unsigned kEscape = 255;         // this symbol's number is in the wide stream

void write_packed(ByteWriter& out, std::string_view raw) { out.bytes() += pack(raw, kLevel); }

std::size_t pixels(int width, int height) { return std::size_t(width) * height; }

/// Predicts a reading from its neighbours (the median predictor of LOCO-I); holes are left out.
class Prediction {
 public:
  Prediction(const Image<std::uint16_t>& ranks, int v)
      : here_(ranks.row(v)), above_(v > 0 ? ranks.row(v - 1) : nullptr) {}

  int at(int u) {
    const int left = u > 0 ? here_[u - 1] : 0;
    const int above = above_ != nullptr ? above_[u] : 0;
    if (left != 0) last_ = left;
    if (left == 0) return above != 0 ? above : last_;
    if (above == 0) return left;
    const int corner = u > 0 ? above_[u - 1] : 0;
    if (corner == 0) return (left + above) / 2;
    return std::max(std::min(left, above), std::min(std::max(left, above), left + above - corner));
  }

 private:
  const std::uint16_t* here_;
  const std::uint16_t* above_;
  int last_ = 1;
};

std::uint8_t predicted_byte(const std::uint8_t* here, const std::uint8_t* above, int u) {
  const int left = u > 0 ? here[u - 1] : above != nullptr ? above[u] : 0;
  return static_cast<std::uint8_t>((left + (above != nullptr ? above[u] : left)) / 2);
}

/// Returns a plane of a colour picture minus its prediction, modulo 256.
std::string residual(const Image<std::uint8_t>& plane) {
  std::string out(plane.size(), '\0');
  auto next = out.begin();
  for (int v = 0; v < plane.height(); ++v) {
    const std::uint8_t* here = plane.row(v);
    const std::uint8_t* above = v > 0 ? plane.row(v - 1) : nullptr;
    for (int u = 0; u < plane.width(); ++u) *next++ = static_cast<char>(here[u] - predicted_byte(here, above, u));
  }
  return out;
}

Image<std::uint8_t> from_residual(const std::string& residual, int width, int height) {
  Image<std::uint8_t> plane(width, height);
  auto next = residual.begin();
  for (int v = 0; v < height; ++v) {
    std::uint8_t* here = plane.row(v);
    const std::uint8_t* above = v > 0 ? plane.row(v - 1) : nullptr;
    for (int u = 0; u < width; ++u) {
      here[u] = static_cast<std::uint8_t>(static_cast<std::uint8_t>(*next++) + predicted_byte(here, above, u));
    }
  }
  return plane;
}

/// Returns the values that occur in ascending order, without holes.
std::vector<std::uint16_t> values_of(const DepthImage& depth) {
  std::uint16_t largest = 0;
  for (const std::uint16_t value : depth) largest = std::max(largest, value);
  std::vector<std::uint8_t> occurs(std::size_t{largest} + 1, 0);
  for (const std::uint16_t value : depth) occurs[value] = 1;
  std::vector<std::uint16_t> values;
  for (std::size_t value = 1; value < occurs.size(); ++value) {
    if (occurs[value] != 0) values.push_back(static_cast<std::uint16_t>(value));
  }
  return values;
}

std::vector<std::uint16_t> read_values(ByteReader& in, std::size_t most) {
  const std::string steps = read_packed(in, 0, kWidestNumber * most, "depth values");
  const std::string name = in.name() + ": depth values";
  ByteReader reader(steps, name);
  std::vector<std::uint16_t> values;
  std::uint32_t value = 0;
  while (reader.left() > 0) {
    const std::uint32_t step = reader.varint("depth values");
    if (step == 0 || step >= kValues || value + step >= kValues) in.fail("depth values: expected ascending ones");
    value += step;
    values.push_back(static_cast<std::uint16_t>(value));
  }
  return values;
}

Image<std::uint8_t> channel(const ColourImage& colour, std::uint8_t (*get)(const Rgb&)) {
  Image<std::uint8_t> plane(colour.width(), colour.height());
  std::transform(colour.begin(), colour.end(), plane.begin(), get);
  return plane;
}

}  // namespace

void check_truth(const LabelledFrame& labelled, int part_count) {
  check(labelled.frame);
  if (!labelled.labels.same_size(labelled.frame.depth) || !labelled.person.same_size(labelled.frame.depth)) {
    throw Error("labels and person must have the size of the depth");
  }
  if (labelled.frame.name.size() > kMaxName) throw Error(fmt::format("name of more than {} bytes", kMaxName));
  const std::size_t people = labelled.parts.size();
  if (people >= kBackground) throw Error(fmt::format("{} people, expected at most 254", people));
  if (const auto label = first_beyond(labelled.labels, part_count)) {
    throw Error(fmt::format("label {}, expected one below {} or {}", *label, part_count, kBackground));
  }
  if (const auto person = first_beyond(labelled.person, people)) {
    throw Error(fmt::format("person {} in the picture, expected one below {} or {}", *person, people, kBackground));
  }
  for (const auto& parts : labelled.parts) {
    if (parts.size() != static_cast<std::size_t>(part_count)) {
      throw Error(fmt::format("person with {} parts, expected {}", parts.size(), part_count));
    }
    for (const Eigen::Vector3f& p : parts) {
      if (p.array().isInf().any()) throw Error("part centre is infinite, expected a point or NaN");
    }
  }
  check_joints(labelled);
  check_circumstances(labelled);
}

std::string encode_frame(const DatasetFrame& frame, int part_count) {
  const LabelledFrame& labelled = frame.labelled;
  with_context(fmt::format("frame {}", frame.index), [&] { check_truth(labelled, part_count); });
  ByteWriter out;
  out.number(frame.index);
  out.number(frame.seed);
  const Frame& picture = labelled.frame;
  out.number(static_cast<std::uint8_t>(flags_of(labelled)));
  out.text(picture.name);
  out.real(picture.time_s.value_or(0.0));
  write_camera(out, picture.camera);
  write_people(out, labelled);
  write_circumstances(out, labelled);
  write_depth_plane(out, picture.depth);
  write_byte_plane(out, labelled.labels);
  write_byte_plane(out, labelled.person);
  if (!picture.colour.empty()) write_colour_plane(out, picture.colour);
  return std::move(out.bytes());
}

DatasetFrame decode_frame(std::string_view bytes, int part_count, const std::string& name, bool with_colour) {
  ByteReader in(bytes, name);
  DatasetFrame frame;
  frame.index = in.number<std::uint64_t>("index");
  frame.seed = in.number<std::uint64_t>("seed");
  const auto flags = in.number<std::uint8_t>("flags");
  if (flags > kAllFlags) in.fail(fmt::format("unknown flags {}", flags));
  LabelledFrame& labelled = frame.labelled;
  labelled.frame.name = in.text("name");
  const double time_s = in.real64("time");
  if ((flags & kHasTime) != 0) labelled.frame.time_s = time_s;
  labelled.frame.camera = read_camera(in);
  read_people(in, part_count, labelled);
  read_circumstances(in, flags, labelled);
  const auto [width, height] = std::pair(labelled.frame.camera.width, labelled.frame.camera.height);
  labelled.frame.depth = read_depth_plane(in, width, height);
  labelled.labels = read_byte_plane(in, width, height);
  labelled.person = read_byte_plane(in, width, height);
  if ((flags & kHasColour) != 0) {
    if (with_colour) {
      labelled.frame.colour = read_colour_plane(in, width, height);
    } else {
      skip_colour_plane(in);
    }
  }
  in.expect_end();
  if (!std::isfinite(time_s)) in.fail("time is not finite");
  with_context(name, [&] { check_truth(labelled, part_count); });
  return frame;
}

void write_depth_plane(ByteWriter& out, const DepthImage& depth) {
  const std::vector<std::uint16_t> values = values_of(depth);
  std::vector<std::uint16_t> rank_of(values.empty() ? 1 : std::size_t{values.back()} + 1, 0);
  ByteWriter steps;
  for (std::size_t i = 0; i < values.size(); ++i) {
    rank_of[values[i]] = static_cast<std::uint16_t>(i + 1);
    steps.varint(values[i] - (i > 0 ? values[i - 1] : 0U));
  }
  Image<std::uint16_t> ranks(depth.width(), depth.height());
  std::transform(depth.begin(), depth.end(), ranks.begin(), [&](std::uint16_t value) { return rank_of[value]; });

  std::string symbols(depth.size(), '\0');
  ByteWriter wide;
  char* next = symbols.data();
  for (int v = 0; v < depth.height(); ++v) {
    Prediction prediction(ranks, v);
    const std::uint16_t* here = ranks.row(v);
    for (int u = 0; u < depth.width(); ++u, ++next) {
      const int expected = prediction.at(u);
      if (here[u] == 0) continue;  // a hole is symbol 0
      const unsigned code = zigzag(here[u] - expected) + 1;
      *next = static_cast<char>(std::min(code, kEscape));
      if (code >= kEscape) wide.varint(code - kEscape);
    }
  }
  write_packed(out, steps.bytes());
  write_packed(out, symbols);
  write_packed(out, wide.bytes());
}

DepthImage read_depth_plane(ByteReader& in, int width, int height) {
  const std::size_t count = pixels(width, height);
  const std::vector<std::uint16_t> values = read_values(in, std::min(count, kValues));
  const std::string symbols = read_packed(in, count, count, "depth");
  const std::string wide_bytes = read_packed(in, 0, kWidestNumber * count, "wide depth steps");
  const std::string name = in.name() + ": wide depth steps";
  ByteReader wide(wide_bytes, name);
  Image<std::uint16_t> ranks(width, height);
  auto next = symbols.begin();
  for (int v = 0; v < height; ++v) {
    Prediction prediction(ranks, v);
    for (int u = 0; u < width; ++u, ++next) {
      const int expected = prediction.at(u);
      unsigned code = static_cast<unsigned char>(*next);
      if (code == 0) continue;
      if (code == kEscape) code += wide.varint("depth");
      const std::int64_t rank = std::int64_t{expected} + unzigzag(code - 1);
      if (rank < 1 || rank > static_cast<std::int64_t>(values.size())) in.fail("depth: no such value");
      ranks(u, v) = static_cast<std::uint16_t>(rank);
    }
  }
  wide.expect_end();
  for (std::uint16_t& rank : ranks) rank = rank == 0 ? std::uint16_t{0} : values[rank - 1U];
  return ranks;
}

void write_byte_plane(ByteWriter& out, const Image<std::uint8_t>& plane) {
  write_packed(out, {reinterpret_cast<const char*>(plane.data()), plane.size()});
}

Image<std::uint8_t> read_byte_plane(ByteReader& in, int width, int height) {
  const std::size_t count = pixels(width, height);
  const std::string bytes = read_packed(in, count, count, "labels");
  Image<std::uint8_t> plane(width, height);
  std::copy(bytes.begin(), bytes.end(), plane.begin());
  return plane;
}

// Red and blue mostly follow green, so their differences from it are small.
void write_colour_plane(ByteWriter& out, const ColourImage& colour) {
  write_packed(out, residual(channel(colour, [](const Rgb& c) { return c.g; })));
  write_packed(out, residual(channel(colour, [](const Rgb& c) { return static_cast<std::uint8_t>(c.r - c.g); })));
  write_packed(out, residual(channel(colour, [](const Rgb& c) { return static_cast<std::uint8_t>(c.b - c.g); })));
}

ColourImage read_colour_plane(ByteReader& in, int width, int height) {
  const std::size_t count = pixels(width, height);
  const auto plane = [&] { return from_residual(read_packed(in, count, count, "colour"), width, height); };
  const Image<std::uint8_t> green = plane();
  const Image<std::uint8_t> red = plane();
  const Image<std::uint8_t> blue = plane();
  ColourImage colour(width, height);
  for (std::size_t i = 0; i < colour.size(); ++i) {
    const std::uint8_t g = green[i];
    colour[i] = {static_cast<std::uint8_t>(red[i] + g), g, static_cast<std::uint8_t>(blue[i] + g)};
  }
  return colour;
}

void skip_colour_plane(ByteReader& in) {
  for (int plane = 0; plane < 3; ++plane) {
    in.number<std::uint32_t>("colour");
    in.text("colour");
  }
}

}  // namespace vesalius
