#include "ros2/messages/people_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/recordings/camera_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/people_messages.h"
#include "ros2/messages/human_frames.h"
#include "ros2/messages/names.h"

namespace vesalius::ros2 {
namespace {

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCameraInfo = "sensor_msgs/CameraInfo";
constexpr const char* kBodies = "/humans/bodies";

/// Returns the same without people who are lost: the others are those whom the messages are about.
TrackedFrame without_lost(const TrackedFrame& tracked) {
  TrackedFrame kept = tracked;
  std::erase_if(kept.people, [](const TrackedPerson& person) { return person.state == TrackState::lost; });
  return kept;
}

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

void check(const PeopleTopicsOptions& options) {
  check_node_name(options.node, "node");
  check_full_name(options.name_space, "namespace", true);
  check_node_name(options.id_prefix, "prefix of ids");
  for (const auto& [from, to] : options.remap) {
    check_full_name(from, "remapped topic");
    check_full_name(to, "remapped topic");
  }
}

PeopleTopics::PeopleTopics(const BodyModel& body, PeopleTopicsOptions options, MessageSink& sink)
    : body_(body), joints_(body), options_(std::move(options)), sink_(sink) {
  check(options_);
}

Topic PeopleTopics::topic(std::string_view name, const char* type, bool latched) const {
  std::string full = resolve_name(name, options_.name_space, options_.node, "topic");
  if (const auto other = options_.remap.find(full); other != options_.remap.end()) full = other->second;
  return {std::move(full), type, latched};
}

template <class Make>
void PeopleTopics::put(const Topic& topic, const Stamp& stamp, const Make& make) {
  if (sink_.wants(topic)) sink_.put(topic, stamp.time_ns, make());
}

void PeopleTopics::write(const Frame& frame, const TrackedFrame& tracked, const std::function<std::string()>& json,
                         const Stamp& stamp) {
  const TrackedFrame people = without_lost(tracked);
  if (options_.frames) write_frame(frame, stamp);
  write_transforms(people, stamp);
  write_bodies(frame, people, stamp);
  write_pictures(frame, people, stamp);
  put(topic("~/markers", "visualization_msgs/MarkerArray"), stamp,
      [&] { return markers_message(people, body_, stamp.time_ns, stamp.frame); });
  put(topic("~/people", "std_msgs/String"), stamp, [&] {
    CdrWriter text;
    text.text(json());
    return text.message();
  });
}

void PeopleTopics::write_frame(const Frame& frame, const Stamp& stamp) {
  put_calibration("~/depth/camera_info", frame.camera, stamp);
  put(topic("~/depth/image_rect", kImage), stamp,
      [&] { return depth_message(frame.depth, stamp.time_ns, stamp.frame); });
  if (frame.colour.empty()) return;
  put_calibration("~/color/camera_info", frame.camera, stamp);
  put(topic("~/color/image_rect", kImage), stamp,
      [&] { return colour_message(frame.colour, stamp.time_ns, stamp.frame); });
}

void PeopleTopics::put_calibration(std::string_view name, const Camera& camera, const Stamp& stamp) {
  put(topic(name, kCameraInfo), stamp, [&] { return calibration_message(camera, stamp.time_ns, stamp.frame); });
}

void PeopleTopics::write_pictures(const Frame& frame, const TrackedFrame& people, const Stamp& stamp) {
  put_calibration("~/camera_info", frame.camera, stamp);
  const Topic index = topic("~/body_index", kImage), labels = topic("~/labels", kImage),
              points = topic("~/points", "sensor_msgs/PointCloud2");
  const bool wants_index = sink_.wants(index), wants_labels = sink_.wants(labels), wants_points = sink_.wants(points);
  if (!wants_index && !wants_labels && !wants_points) return;
  const int width = frame.depth.width(), height = frame.depth.height();
  const std::vector<Person> found = people_of(people);
  const Image<std::uint8_t> bodies = body_index_map(found, width, height);
  const LabelImage parts = part_label_map(found, width, height);
  if (wants_index) sink_.put(index, stamp.time_ns, grey_message(bodies, stamp.time_ns, stamp.frame));
  if (wants_labels) sink_.put(labels, stamp.time_ns, grey_message(parts, stamp.time_ns, stamp.frame));
  if (!wants_points) return;
  std::vector<int> ids;
  for (const TrackedPerson& person : people.people) ids.push_back(person.id);
  sink_.put(points, stamp.time_ns,
            cloud_message(frame, bodies, parts, ids, options_.cloud, stamp.time_ns, stamp.frame));
}

void PeopleTopics::write_transforms(const TrackedFrame& people, const Stamp& stamp) {
  const Topic transforms = topic("/tf", "tf2_msgs/TFMessage");
  if (!sink_.wants(transforms)) return;
  const Eigen::Vector3f up = people.floor.value_or(FloorView{}).up;
  std::vector<FrameTransform> frames;
  for (const TrackedPerson& person : people.people) {
    std::ranges::move(human_frames(person, joints_, id_of(person.id), stamp.frame, up), std::back_inserter(frames));
  }
  if (frames.empty()) return;
  sink_.put(transforms, stamp.time_ns, transforms_message(frames, stamp.time_ns));
}

void PeopleTopics::write_bodies(const Frame& frame, const TrackedFrame& people, const Stamp& stamp) {
  std::vector<std::string> ids;
  for (const TrackedPerson& person : people.people) ids.push_back(id_of(person.id));
  write_ids(ids, stamp);
  for (const TrackedPerson& person : people.people) {
    const std::string id = id_of(person.id);
    bodies_.insert(id);
    if (const auto box = region_message(person, frame.camera, stamp.time_ns, stamp.frame)) {
      put(topic(fmt::format("{}/{}/roi", kBodies, id), "hri_msgs/NormalizedRegionOfInterest2D"), stamp,
          [&] { return *box; });
    }
    put(topic(fmt::format("{}/{}/skeleton2d", kBodies, id), "hri_msgs/Skeleton2D"), stamp,
        [&] { return skeleton_message(person, joints_, frame.camera, stamp.time_ns, stamp.frame); });
  }
}

void PeopleTopics::write_ids(const std::vector<std::string>& ids, const Stamp& stamp) {
  end_bodies_but({ids.begin(), ids.end()});
  put(topic(fmt::format("{}/tracked", kBodies), "hri_msgs/IdsList", true), stamp,
      [&] { return ids_message(ids, stamp.time_ns, stamp.frame); });
}

void PeopleTopics::end_bodies_but(const std::set<std::string>& ids) {
  std::erase_if(bodies_, [&](const std::string& id) {
    if (ids.contains(id)) return false;
    for (const char* name : {"roi", "skeleton2d"})
      sink_.end(topic(fmt::format("{}/{}/{}", kBodies, id, name), "").name);
    return true;
  });
}

void PeopleTopics::write_camera_pose(const std::string& parent, const Eigen::Isometry3d& parent_from_optical,
                                     const Stamp& stamp) {
  sink_.put(topic("/tf_static", "tf2_msgs/TFMessage", true), stamp.time_ns,
            transforms_message({{parent, stamp.frame, parent_from_optical}}, stamp.time_ns));
}

void PeopleTopics::clear(const Stamp& stamp) { write_ids({}, stamp); }

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
