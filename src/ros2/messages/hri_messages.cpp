#include "ros2/messages/hri_messages.h"

#include <array>

#include "io/recordings/message_fields.h"

namespace vesalius::ros2 {
namespace {

/// In the order of hri_msgs/Skeleton2D.
constexpr std::array<std::string_view, 18> kSkeleton{
    "nose",   "neck",    "r_shoulder", "r_elbow", "r_wrist", "l_shoulder", "l_elbow", "l_wrist", "r_hip",
    "r_knee", "r_ankle", "l_hip",      "l_knee",  "l_ankle", "l_eye",      "r_eye",   "l_ear",   "r_ear"};

/// Returns where a joint is in parts of the picture, and its confidence; zeros if it is not in it.
Eigen::Vector3f in_picture(const std::optional<Joint>& joint, const Camera& camera) {
  if (!joint || joint->position.z() <= 0.F) return Eigen::Vector3f::Zero();
  const Eigen::Vector2f pixel = camera.pixel(joint->position);
  const float x = (pixel.x() + 0.5F) / float(camera.width);
  const float y = (pixel.y() + 0.5F) / float(camera.height);
  // Written so that not-a-number is refused too.
  if (!(x >= 0.F && x <= 1.F && y >= 0.F && y <= 1.F)) return Eigen::Vector3f::Zero();
  return {x, y, joint->confidence};
}

}  // namespace

std::string ids_message(const std::vector<std::string>& ids, std::int64_t time_ns, std::string_view frame) {
  CdrWriter out;
  out.header(time_ns, frame);
  out.u32(static_cast<std::uint32_t>(ids.size()));
  for (const std::string& id : ids) out.text(id);
  return out.message();
}

std::optional<std::string> region_message(const TrackedPerson& person, const Camera& camera, std::int64_t time_ns,
                                          std::string_view frame) {
  const Box& box = person.person.box;
  if (box.width <= 0 || box.height <= 0) return std::nullopt;
  const auto width = float(camera.width), height = float(camera.height);
  CdrWriter out;
  out.header(time_ns, frame);
  out.real32(float(box.u) / width);
  out.real32(float(box.v) / height);
  out.real32(float(box.u + box.width) / width);
  out.real32(float(box.v + box.height) / height);
  out.real32(person.person.score);
  return out.message();
}

std::string skeleton_message(const TrackedPerson& person, const NamedJoints& joints, const Camera& camera,
                             std::int64_t time_ns, std::string_view frame) {
  CdrWriter out;
  out.header(time_ns, frame);
  for (const std::string_view name : kSkeleton) {
    const Eigen::Vector3f point = in_picture(joints.find(person, name), camera);
    for (int i = 0; i < 3; ++i) out.real32(point[i]);
  }
  return out.message();
}

}  // namespace vesalius::ros2
