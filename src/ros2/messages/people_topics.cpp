#include "ros2/messages/people_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/recordings/camera_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/people_messages.h"
#include "ros2/messages/hri_messages.h"
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

void PeopleTopics::write(const Frame& frame, const TrackedFrame& tracked, const std::string& json, const Stamp& stamp) {
  const TrackedFrame people = without_lost(tracked);
  if (options_.frames) write_frame(frame, stamp);
  write_transforms(people, stamp);
  write_bodies(frame, people, stamp);
  write_pictures(frame, people, stamp);
  if (const Topic markers = topic("~/markers", "visualization_msgs/MarkerArray"); sink_.wants(markers)) {
    sink_.put(markers, stamp.time_ns, markers_message(people, body_, stamp.time_ns, stamp.frame));
  }
  CdrWriter text;
  text.text(json);
  sink_.put(topic("~/people", "std_msgs/String"), stamp.time_ns, text.message());
}

void PeopleTopics::write_frame(const Frame& frame, const Stamp& stamp) {
  const auto put = [&](const char* name, const char* info, const auto& picture) {
    const Topic image = topic(name, kImage), camera = topic(info, kCameraInfo);
    if (sink_.wants(camera)) {
      sink_.put(camera, stamp.time_ns, calibration_message(frame.camera, stamp.time_ns, stamp.frame));
    }
    if (sink_.wants(image)) sink_.put(image, stamp.time_ns, picture());
  };
  put("~/depth/image_rect", "~/depth/camera_info",
      [&] { return depth_message(frame.depth, stamp.time_ns, stamp.frame); });
  if (frame.colour.empty()) return;
  put("~/color/image_rect", "~/color/camera_info",
      [&] { return colour_message(frame.colour, stamp.time_ns, stamp.frame); });
}

void PeopleTopics::write_pictures(const Frame& frame, const TrackedFrame& people, const Stamp& stamp) {
  const Topic camera = topic("~/camera_info", kCameraInfo), index = topic("~/body_index", kImage),
              labels = topic("~/labels", kImage), points = topic("~/points", "sensor_msgs/PointCloud2");
  if (sink_.wants(camera)) {
    sink_.put(camera, stamp.time_ns, calibration_message(frame.camera, stamp.time_ns, stamp.frame));
  }
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
  const Eigen::Vector3f up = people.floor.value_or(FloorView{}).up;
  std::vector<FrameTransform> frames;
  for (const TrackedPerson& person : people.people) {
    std::ranges::move(human_frames(person, joints_, id_of(person.id), stamp.frame, up), std::back_inserter(frames));
  }
  if (frames.empty()) return;
  sink_.put(topic("/tf", "tf2_msgs/TFMessage"), stamp.time_ns, transforms_message(frames, stamp.time_ns));
}

void PeopleTopics::write_bodies(const Frame& frame, const TrackedFrame& people, const Stamp& stamp) {
  std::vector<std::string> ids;
  for (const TrackedPerson& person : people.people) ids.push_back(id_of(person.id));
  end_bodies_but({ids.begin(), ids.end()});
  sink_.put(topic(fmt::format("{}/tracked", kBodies), "hri_msgs/IdsList", true), stamp.time_ns,
            ids_message(ids, stamp.time_ns, stamp.frame));
  for (const TrackedPerson& person : people.people) {
    const std::string id = id_of(person.id);
    bodies_.insert(id);
    const Topic region = topic(fmt::format("{}/{}/roi", kBodies, id), "hri_msgs/NormalizedRegionOfInterest2D"),
                skeleton = topic(fmt::format("{}/{}/skeleton2d", kBodies, id), "hri_msgs/Skeleton2D");
    if (const auto box = region_message(person, frame.camera, stamp.time_ns, stamp.frame); box && sink_.wants(region)) {
      sink_.put(region, stamp.time_ns, *box);
    }
    if (sink_.wants(skeleton)) {
      sink_.put(skeleton, stamp.time_ns, skeleton_message(person, joints_, frame.camera, stamp.time_ns, stamp.frame));
    }
  }
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

void PeopleTopics::clear(const Stamp& stamp) {
  end_bodies_but({});
  sink_.put(topic(fmt::format("{}/tracked", kBodies), "hri_msgs/IdsList", true), stamp.time_ns,
            ids_message({}, stamp.time_ns, stamp.frame));
}

}  // namespace vesalius::ros2
