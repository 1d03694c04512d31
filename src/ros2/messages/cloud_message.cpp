#include "ros2/messages/cloud_message.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "io/recordings/message_fields.h"

namespace vesalius::ros2 {
namespace {

// Numbers of sensor_msgs/PointField.
constexpr std::uint8_t kUint32 = 6, kFloat32 = 7;

struct Field {
  const char* name;
  std::uint8_t type;
};
constexpr std::array<Field, 6> kFields{
    {{"x", kFloat32}, {"y", kFloat32}, {"z", kFloat32}, {"rgb", kFloat32}, {"label", kUint32}, {"body", kUint32}}};

/// A point as its fields lie in the message.
struct Point {
  float x, y, z;
  std::uint32_t rgb, label, body;
};
static_assert(sizeof(Point) == 4 * kFields.size());
static_assert(std::endian::native == std::endian::little);

Point point_of(const Frame& frame, int u, int v, std::uint32_t label, std::uint32_t body) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  std::uint32_t rgb = 0;
  if (!frame.colour.empty()) {
    const Rgb colour = frame.colour(u, v);
    rgb = static_cast<std::uint32_t>(colour.r) << 16U | static_cast<std::uint32_t>(colour.g) << 8U | colour.b;
  }
  if (frame.depth(u, v) == 0) return {kNone, kNone, kNone, rgb, label, body};
  const Eigen::Vector3f at = point_at(frame.camera, frame.depth, u, v);
  return {at.x(), at.y(), at.z(), rgb, label, body};
}

}  // namespace

std::string cloud_message(const Frame& frame, const Image<std::uint8_t>& index, const LabelImage& parts,
                          const std::vector<int>& ids, CloudExtent extent, std::int64_t time_ns,
                          std::string_view frame_id) {
  const int width = frame.depth.width(), height = frame.depth.height();
  std::vector<Point> points;
  if (extent == CloudExtent::frame) points.reserve(frame.depth.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const std::uint8_t person = index(u, v);
      const bool somebody = person != kBackground && person < ids.size();
      if (extent == CloudExtent::people && (!somebody || frame.depth(u, v) == 0)) continue;
      points.push_back(
          point_of(frame, u, v, parts(u, v), somebody ? static_cast<std::uint32_t>(ids[person]) : std::uint32_t{0}));
    }
  }
  const bool organised = extent == CloudExtent::frame;
  const auto columns = organised ? static_cast<std::uint32_t>(width) : static_cast<std::uint32_t>(points.size());
  CdrWriter out;
  out.header(time_ns, frame_id);
  out.u32(organised ? static_cast<std::uint32_t>(height) : 1U);
  out.u32(columns);
  out.u32(static_cast<std::uint32_t>(kFields.size()));
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    out.text(kFields[i].name);
    out.u32(static_cast<std::uint32_t>(4 * i));
    out.u8(kFields[i].type);
    out.u32(1);
  }
  out.u8(0);  // little-endian
  out.u32(sizeof(Point));
  out.u32(columns * static_cast<std::uint32_t>(sizeof(Point)));
  out.bytes({reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Point)});
  out.u8(organised ? 0 : 1);  // whether all points are numbers
  return out.message();
}

}  // namespace vesalius::ros2
