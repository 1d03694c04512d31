#include "vesalius/person_json.h"

#include <nlohmann/json.hpp>
#include <type_traits>

#include "stream/json_numbers.h"
#include "stream/person_fields.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

// What kinds of values become. Times are the only doubles.
Json value_json(int value) { return value; }
Json value_json(bool value) { return value; }
Json value_json(float value) { return rounded(value); }
Json value_json(double time_s) { return rounded(time_s, 1e6); }
Json value_json(const Eigen::Vector3f& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }
Json value_json(const Eigen::Quaternionf& q) {
  return {rounded(q.x()), rounded(q.y()), rounded(q.z()), rounded(q.w())};
}
Json value_json(const std::vector<float>& values) {
  Json numbers = Json::array();
  for (const float value : values) numbers.push_back(rounded(value));
  return numbers;
}
Json value_json(const Box& box) { return {box.u, box.v, box.width, box.height}; }
/// A covariance in square metres, as square millimetres.
Json value_json(const Eigen::Matrix3f& c) {
  constexpr double kSquareMillimetres = 1e6;
  Json numbers = Json::array();
  for (const float number : {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)}) {
    numbers.push_back(rounded(double(number) * kSquareMillimetres, 10));
  }
  return numbers;
}
template <class Enum>
requires std::is_enum_v<Enum> Json value_json(Enum value) { return to_string(value); }
Json value_json(const std::optional<YawEstimate>& yaw) {
  if (!yaw) return {};
  return {{"degrees", rounded(kDegrees * double(yaw->yaw_rad), 10)}, {"confidence", rounded(yaw->confidence)}};
}

template <class Struct>
Json fields_json(const Struct& of) {
  Json json = Json::object();
  visit_fields<Struct>([&](const auto& field) { json[key_of(field)] = value_json(of.*field.member); });
  return json;
}

const Eigen::Vector3f& place_of(const Joint& joint) { return joint.position; }
const Eigen::Vector3f& place_of(const SkeletonPart& part) { return part.centre; }

/// Parts or joints by their names. Without a camera they have no pixels and no reasons.
template <class Named, class Point>
Json points_json(const std::vector<Named>& names, const std::vector<Point>& points, const Camera* camera) {
  Json all = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Point& point = points.at(i);
    Json xyz, px;  // null
    if (point.state != State::none) xyz = value_json(place_of(point));
    if (camera != nullptr && point.state != State::none && place_of(point).z() > 0.F) {
      const Eigen::Vector2f pixel = camera->pixel(place_of(point));
      px = {rounded(pixel.x(), 10), rounded(pixel.y(), 10)};
    }
    Json& json = all[names[i].name] = {{"xyz_m", xyz}};
    if (camera != nullptr) json["px"] = px;
    json["confidence"] = point.state == State::none ? 0.0 : rounded(point.confidence);
    json["state"] = to_string(point.state);
    if (camera == nullptr || point.unseen == Unseen::none) continue;
    json["unseen"] = to_string(point.unseen);
    if (point.behind >= 0) json["behind"] = point.behind;
  }
  return all;
}

Json camera_json(const Camera& camera) {
  return {{"width", camera.width},     {"height", camera.height},   {"fx", shortest(camera.fx)},
          {"fy", shortest(camera.fy)}, {"cx", shortest(camera.cx)}, {"cy", shortest(camera.cy)}};
}

Json joints_json(const std::vector<std::vector<Joint>>& joints, const BodyModel& body, const Camera* camera,
                 const JsonOptions& options) {
  Json sets = Json::object();
  for (std::size_t s = 0; s < body.joint_sets.size(); ++s) {
    if (!options.joints.empty() && body.joint_sets[s].name != options.joints) continue;
    sets[body.joint_sets[s].name] = points_json(body.joint_sets[s].joints, joints.at(s), camera);
  }
  return sets;
}

/// File names need not be UTF-8; JSON must.
std::string line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Takes the camera's own time; `latency_ms` as frame_json.
Json frame_facts(const Frame& frame, std::optional<double> latency_ms) {
  Json json = {{"frame", frame.name}, {"time_s", frame.time_s ? Json(rounded(*frame.time_s, 1e6)) : Json()}};
  if (frame.arrived_s) json["arrived_s"] = rounded(*frame.arrived_s, 1e6);
  if (latency_ms) json["latency_ms"] = rounded(*latency_ms, 1e3);
  if (frame.up) json["up"] = value_json(*frame.up);
  json["camera"] = camera_json(frame.camera);
  return json;
}

Json body_json(const TrackedPerson& person, const BodyModel& body, const JsonOptions& options) {
  Json json = fields_json(*person.body);
  Json& bones = json["bones"] = Json::object();
  const std::vector<FleshBone>& names = builtin_flesh().bones;
  for (std::size_t b = 0; b < person.body->bones.size() && b < names.size(); ++b) {
    bones[names[b].name] = fields_json(person.body->bones[b]);
  }
  // Of the joint sets that have some, in the sets' own conventions.
  Json& sets = json["joint_rotations_xyzw"] = Json::object();
  for (const JointSet& set : body.joint_sets) {
    if (!options.joints.empty() && set.name != options.joints) continue;
    const auto rotations = rotations_of(person, set);
    for (std::size_t j = 0; j < rotations.size(); ++j) {
      if (rotations[j]) sets[set.name][set.joints[j].name] = value_json(*rotations[j]);
    }
  }
  return json;
}

Json cameras_json(const std::vector<SeenBy>& cameras) {
  Json list = Json::array();
  for (const SeenBy& seen : cameras) {
    list.push_back({{"camera", seen.camera}, {"id", seen.id}, {"state", to_string(seen.state)}});
  }
  return list;
}

Json person_json(const TrackedPerson& tracked, bool followed, std::size_t index, const BodyModel& body,
                 const Camera& camera, const JsonOptions& options) {
  const Person& person = tracked.person;
  Json json = followed ? fields_json(tracked) : Json::object();
  json["index"] = index;
  if (!tracked.seen_by.empty()) json["cameras"] = cameras_json(tracked.seen_by);
  json.update(fields_json(person));
  if (!options.brief) json["parts"] = points_json(body.parts, person.skeleton.parts, &camera);
  json["joints"] = joints_json(person.joints, body, options.brief ? nullptr : &camera, options);
  if (options.brief) return json;
  if (tracked.body) json["body"] = body_json(tracked, body, options);
  if (!tracked.smoothed.empty()) json["smoothed"] = joints_json(tracked.smoothed, body, &camera, options);
  return json;
}

Json floor_json(const std::optional<FloorView>& floor) {
  if (!floor) return {};
  return {{"up", value_json(floor->up)},
          {"height_m", rounded(floor->height_m)},
          {"tilt_degrees", rounded(kDegrees * double(floor->tilt_rad), 10)},
          {"roll_degrees", rounded(kDegrees * double(floor->roll_rad), 10)}};
}

Json events_json(const std::vector<StanceEvent>& events) {
  Json list = Json::array();
  for (const StanceEvent& event : events) {
    list.push_back({{"id", event.id}, {"time_s", value_json(event.time_s)}, {"stance", to_string(event.stance)}});
  }
  return list;
}

}  // namespace

std::string frame_json(const Frame& frame, const TrackedFrame& people, const BodyModel& body,
                       std::optional<double> latency_ms, const JsonOptions& options) {
  if (!options.joints.empty()) (void)find_joint_set(body, options.joints);  // there is one
  Json json = frame_facts(frame, latency_ms);
  if (people.followed) {
    json["track_time_s"] = value_json(people.time_s);
    json["floor"] = floor_json(people.floor);
    json["events"] = events_json(people.events);
  }
  Json& list = json["people"] = Json::array();
  for (const TrackedPerson& person : people.people) {
    list.push_back(person_json(person, people.followed, list.size(), body, frame.camera, options));
  }
  return line(json);
}

std::vector<std::string> json_datagrams(const std::string& whole, std::size_t most) {
  if (whole.size() <= most) return {whole};
  Json frame = Json::parse(whole);
  const Json people = std::move(frame.at("people"));
  std::vector<std::string> datagrams;
  for (std::size_t i = 0; i < people.size(); ++i) {
    frame["people"] = Json::array({people[i]});
    frame["part"] = i;
    frame["parts"] = people.size();
    datagrams.push_back(line(frame));
  }
  return datagrams;
}

std::string closing_json(int lines, bool complete, const std::string& why) {
  Json json = {{"complete", complete}, {"frames", lines}};
  if (!why.empty()) json["why"] = why;
  return line(json);
}

std::string part_table_json(const BodyModel& body) {
  Json parts = Json::array();
  for (std::size_t p = 0; p < body.parts.size(); ++p) {
    const BodyPart& part = body.parts[p];
    parts.push_back({{"label", p},
                     {"name", part.name},
                     {"colour", {part.colour.r, part.colour.g, part.colour.b}},
                     {"mirror", part.mirror}});
  }
  const Json table = {{"body", body.name}, {"background", kBackground}, {"parts", std::move(parts)}};
  return table.dump(2) + "\n";
}

}  // namespace vesalius
