#include "io/recordings/people_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "io/recordings/message_fields.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

// Numbers of visualization_msgs/Marker.
constexpr std::int32_t kLineList = 5, kSphereList = 7, kText = 9, kAdd = 0, kDeleteAll = 3;

constexpr double kBall_m = 0.06, kLine_m = 0.02, kText_m = 0.12;
/// The text stands so far above the highest part.
constexpr float kAbove_m = 0.25F;
constexpr float kPale = 0.35F;

struct Definition {
  std::string_view type;
  std::string_view fields;
  std::vector<std::string_view> uses;
};

/// Types of common_interfaces, geometry2 and hri_msgs, by their fields.
const std::vector<Definition>& definitions() {
  static const std::vector<Definition> all = {
      {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n", {}},
      {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n", {}},
      {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n", {"builtin_interfaces/Time"}},
      {"std_msgs/String", "string data\n", {}},
      {"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n", {}},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n", {}},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n", {}},
      {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", {}},
      {"geometry_msgs/Pose",
       "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
       {"geometry_msgs/Point", "geometry_msgs/Quaternion"}},
      {"sensor_msgs/Image",
       "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
       "uint8[] data\n",
       {"std_msgs/Header"}},
      {"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n", {"std_msgs/Header"}},
      {"sensor_msgs/RegionOfInterest",
       "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n",
       {}},
      {"sensor_msgs/CameraInfo",
       "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
       "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n",
       {"std_msgs/Header", "sensor_msgs/RegionOfInterest"}},
      {"sensor_msgs/Imu",
       "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
       "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
       "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
       {"std_msgs/Header", "geometry_msgs/Quaternion", "geometry_msgs/Vector3"}},
      {"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n", {}},
      {"visualization_msgs/MeshFile", "string filename\nuint8[] data\n", {}},
      {"visualization_msgs/Marker",
       "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n"
       "geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n"
       "bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n"
       "sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\n"
       "string mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n",
       {"std_msgs/Header", "geometry_msgs/Pose", "geometry_msgs/Vector3", "std_msgs/ColorRGBA",
        "builtin_interfaces/Duration", "geometry_msgs/Point", "sensor_msgs/CompressedImage",
        "visualization_msgs/UVCoordinate", "visualization_msgs/MeshFile"}},
      {"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n", {}},
      {"sensor_msgs/PointCloud2",
       "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n"
       "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
       {"std_msgs/Header", "sensor_msgs/PointField"}},
      {"geometry_msgs/Transform",
       "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
       {"geometry_msgs/Vector3", "geometry_msgs/Quaternion"}},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
       {"std_msgs/Header", "geometry_msgs/Transform"}},
      {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n", {"geometry_msgs/TransformStamped"}},
      {"hri_msgs/IdsList", "std_msgs/Header header\nstring[] ids\n", {"std_msgs/Header"}},
      {"hri_msgs/NormalizedRegionOfInterest2D",
       "std_msgs/Header header\nfloat32 xmin\nfloat32 ymin\nfloat32 xmax\nfloat32 ymax\nfloat32 c\n",
       {"std_msgs/Header"}},
      {"hri_msgs/NormalizedPointOfInterest2D", "float32 x\nfloat32 y\nfloat32 c\n", {}},
      {"hri_msgs/Skeleton2D",
       "std_msgs/Header header\nhri_msgs/NormalizedPointOfInterest2D[18] skeleton\n",
       {"std_msgs/Header", "hri_msgs/NormalizedPointOfInterest2D"}},
      {"visualization_msgs/MarkerArray", "visualization_msgs/Marker[] markers\n", {"visualization_msgs/Marker"}},
  };
  return all;
}

const Definition& definition_of(std::string_view type) {
  const auto found = std::ranges::find(definitions(), type, &Definition::type);
  if (found == definitions().end()) throw Error(fmt::format("no definition of the message type {}", type));
  return *found;
}

/// Adds a type and all that it is made of, each once.
void collect(std::string_view type, std::vector<const Definition*>& into) {
  const Definition& one = definition_of(type);
  if (std::ranges::find(into, &one) != into.end()) return;
  into.push_back(&one);
  for (const std::string_view used : one.uses) collect(used, into);
}

struct Ball {
  Eigen::Vector3f at;
  Rgb colour;
  float opacity;
};

struct MarkerStyle {
  std::int32_t type, action;
  std::array<double, 3> scale_m;
};

void write_colour(CdrWriter& out, Rgb colour, float opacity) {
  constexpr float kFull = 255.F;
  for (const std::uint8_t value : {colour.r, colour.g, colour.b}) out.real32(float(value) / kFull);
  out.real32(opacity);
}

void write_point(CdrWriter& out, const Eigen::Vector3f& point) {
  for (int i = 0; i < 3; ++i) out.real64(double(point[i]));
}

/// Writes one marker. Its colours are those of the balls.
void write_marker(CdrWriter& out, std::int64_t time_ns, std::string_view frame, int id, const MarkerStyle& style,
                  const Eigen::Vector3f& at, const std::vector<Ball>& balls, const std::string& text) {
  out.header(time_ns, frame);
  out.text("people");
  out.i32(id);
  out.i32(style.type);
  out.i32(style.action);
  write_point(out, at);
  for (const double q : {0.0, 0.0, 0.0, 1.0}) out.real64(q);
  for (const double scale : style.scale_m) out.real64(scale);
  write_colour(out, {255, 255, 255}, 1.F);
  out.i32(0);  // stays until the next array
  out.u32(0);
  out.u8(0);
  out.u32(static_cast<std::uint32_t>(balls.size()));
  for (const Ball& ball : balls) write_point(out, ball.at);
  out.u32(static_cast<std::uint32_t>(balls.size()));
  for (const Ball& ball : balls) write_colour(out, ball.colour, ball.opacity);
  out.text("");  // no texture
  out.header(0, "");
  out.text("");
  out.bytes("");
  out.u32(0);
  out.text(text);
  out.text("");  // no mesh
  out.text("");
  out.bytes("");
  out.u8(0);
}

Ball ball_of(const SkeletonPart& part, const BodyPart& of) {
  return {part.centre, of.colour, part.state == State::observed ? 1.F : kPale};
}

std::string name_of(const TrackedPerson& person) {
  if (person.state == TrackState::seen) return fmt::format("{}: {:.2f}", person.id, person.person.score);
  return fmt::format("{} {}", person.id, to_string(person.state));
}

}  // namespace

std::string markers_message(const TrackedFrame& people, const BodyModel& body, std::int64_t time_ns,
                            std::string_view frame) {
  constexpr std::uint32_t kMarkers = 3;  // of a person
  const auto lost = std::ranges::count(people.people, TrackState::lost, &TrackedPerson::state);
  CdrWriter out;
  out.u32(1 + kMarkers * static_cast<std::uint32_t>(people.people.size() - static_cast<std::size_t>(lost)));
  const Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  write_marker(out, time_ns, frame, 0, {0, kDeleteAll, {1, 1, 1}}, origin, {}, "");
  int id = 1;
  for (const TrackedPerson& person : people.people) {
    if (person.state == TrackState::lost) continue;
    const std::vector<SkeletonPart>& parts = person.person.skeleton.parts;
    std::vector<Ball> balls, lines;
    Eigen::Vector3f highest(0.F, std::numeric_limits<float>::max(), 0.F);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].state == State::none) continue;
      balls.push_back(ball_of(parts[i], body.parts[i]));
      if (parts[i].centre.y() < highest.y()) highest = parts[i].centre;
    }
    // Of whom no part is known, the points begin at the top.
    if (balls.empty() && !person.person.points.empty()) highest = person.person.points.front().at;
    for (const BodyLink& link : body.links) {
      if (parts[link.parent].state == State::none || parts[link.child].state == State::none) continue;
      lines.push_back(ball_of(parts[link.parent], body.parts[link.parent]));
      lines.push_back(ball_of(parts[link.child], body.parts[link.child]));
    }
    write_marker(out, time_ns, frame, id++, {kLineList, kAdd, {kLine_m, 0, 0}}, origin, lines, "");
    write_marker(out, time_ns, frame, id++, {kSphereList, kAdd, {kBall_m, kBall_m, kBall_m}}, origin, balls, "");
    write_marker(out, time_ns, frame, id++, {kText, kAdd, {0, 0, kText_m}},
                 highest - Eigen::Vector3f(0.F, kAbove_m, 0.F), {}, name_of(person));
  }
  return out.message();
}

std::string message_definition(std::string_view type) {
  std::vector<const Definition*> all;
  collect(type, all);
  std::string text(all.front()->fields);
  for (std::size_t i = 1; i < all.size(); ++i) {
    text += fmt::format("{:=<80}\nMSG: {}\n{}", "", all[i]->type, all[i]->fields);
  }
  return text;
}

}  // namespace vesalius
