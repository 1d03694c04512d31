#include "dataset/labelled_frame_codec.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "dataset/plane_codec.h"
#include "io/files/image_bytes.h"

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

}  // namespace vesalius
