#include "stream/person_json.h"

#include <nlohmann/json.hpp>
#include <numbers>

#include "stream/json_numbers.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

Json point_json(State state, const Eigen::Vector3f& point, float confidence, const Camera& camera) {
  Json xyz, px;  // null
  if (state != State::none) {
    xyz = {rounded(point.x()), rounded(point.y()), rounded(point.z())};
    if (point.z() > 0.F) {
      const Eigen::Vector2f pixel = camera.pixel(point);
      px = {rounded(pixel.x(), 10), rounded(pixel.y(), 10)};
    }
  }
  return {{"xyz_m", xyz},
          {"px", px},
          {"confidence", state == State::none ? 0.0 : rounded(confidence)},
          {"state", to_string(state)}};
}

Json camera_json(const Camera& camera) {
  return {{"width", camera.width},     {"height", camera.height},   {"fx", shortest(camera.fx)},
          {"fy", shortest(camera.fy)}, {"cx", shortest(camera.cx)}, {"cy", shortest(camera.cy)}};
}

Json parts_json(const Skeleton& skeleton, const BodyModel& body, const Camera& camera) {
  Json parts = Json::object();
  for (std::size_t p = 0; p < body.parts.size(); ++p) {
    const SkeletonPart& part = skeleton.parts.at(p);
    parts[body.parts[p].name] = point_json(part.state, part.centre, part.confidence, camera);
  }
  return parts;
}

Json joints_json(const std::vector<std::vector<Joint>>& all, const BodyModel& body, const Camera& camera) {
  Json sets = Json::object();
  for (std::size_t s = 0; s < body.joint_sets.size(); ++s) {
    const JointSet& set = body.joint_sets[s];
    Json joints = Json::object();
    for (std::size_t j = 0; j < set.joints.size(); ++j) {
      const Joint& joint = all.at(s).at(j);
      joints[set.joints[j].name] = point_json(joint.state, joint.position, joint.confidence, camera);
    }
    sets[set.name] = std::move(joints);
  }
  return sets;
}

Json yaw_json(const std::optional<YawEstimate>& yaw) {
  if (!yaw) return {};
  return {{"degrees", rounded(kDegrees * static_cast<double>(yaw->yaw_rad), 10)},
          {"confidence", rounded(yaw->confidence)}};
}

/// File names need not be UTF-8; JSON must.
std::string line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json xyz_json(const Eigen::Vector3f& point) { return {rounded(point.x()), rounded(point.y()), rounded(point.z())}; }

Json person_json(const Person& person, std::size_t index, const BodyModel& body, const Camera& camera) {
  return {{"index", index},
          {"score", rounded(person.score)},
          {"yaw", yaw_json(person.yaw)},
          {"box_px", {person.box.u, person.box.v, person.box.width, person.box.height}},
          {"parts", parts_json(person.skeleton, body, camera)},
          {"joints", joints_json(person.joints, body, camera)}};
}

/// Takes the camera's own time; `latency_ms` as frame_json.
Json frame_facts(const Frame& frame, std::optional<double> latency_ms) {
  Json json = {{"frame", frame.name}, {"time_s", frame.time_s ? Json(rounded(*frame.time_s, 1e6)) : Json()}};
  if (frame.arrived_s) json["arrived_s"] = rounded(*frame.arrived_s, 1e6);
  if (latency_ms) json["latency_ms"] = rounded(*latency_ms, 1e3);
  if (frame.up) json["up"] = xyz_json(*frame.up);
  json["camera"] = camera_json(frame.camera);
  return json;
}

Json xyzw_json(const Eigen::Quaternionf& q) { return {rounded(q.x()), rounded(q.y()), rounded(q.z()), rounded(q.w())}; }

/// Returns the joints' rotations of the joint sets that have some, in the sets' own conventions.
Json rotations_json(const FittedBody& fitted, const BodyModel& body) {
  Json sets = Json::object();
  for (const JointSet& set : body.joint_sets) {
    const auto rotations = joint_rotations(fitted, builtin_flesh_joints(), set);
    for (std::size_t j = 0; j < rotations.size(); ++j) {
      if (rotations[j]) sets[set.name][set.joints[j].name] = xyzw_json(*rotations[j]);
    }
  }
  return sets;
}

/// Bones by name. Rotations are xyzw, `global` into the optical frame, `local` into the parent's.
Json body_json(const FittedBody& fitted, const BodyModel& body) {
  Json bones = Json::object();
  const std::vector<FleshBone>& names = builtin_flesh().bones;
  for (std::size_t b = 0; b < fitted.bones.size() && b < names.size(); ++b) {
    const FittedBone& bone = fitted.bones[b];
    const Eigen::Matrix3f& c = bone.covariance;
    constexpr double kSquareMillimetres = 1e6;
    Json covariance = Json::array();
    for (const float number : {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)}) {
      covariance.push_back(rounded(static_cast<double>(number) * kSquareMillimetres, 10));
    }
    bones[names[b].name] = {{"head_m", xyz_json(bone.head)},          {"tail_m", xyz_json(bone.tail)},
                            {"length_m", rounded(bone.length_m)},     {"global_xyzw", xyzw_json(bone.global)},
                            {"local_xyzw", xyzw_json(bone.local)},    {"covariance_mm2", covariance},
                            {"confidence", rounded(bone.confidence)}, {"state", to_string(bone.state)}};
  }
  return {{"stature_m", rounded(fitted.stature_m)},
          {"misfit", rounded(fitted.misfit)},
          {"bones", bones},
          {"joint_rotations_xyzw", rotations_json(fitted, body)}};
}

Json tracked_json(const TrackedPerson& tracked, std::size_t index, const BodyModel& body, const Camera& camera) {
  Json json = {{"id", tracked.id},
               {"state", to_string(tracked.state)},
               {"position_m", xyz_json(tracked.position)},
               {"velocity_m_s", xyz_json(tracked.velocity)},
               {"stance", to_string(tracked.stance)},
               {"leaving", tracked.leaving},
               {"since_s", rounded(tracked.since_s, 1e6)},
               {"seen_s", rounded(tracked.seen_s, 1e6)}};
  json.update(person_json(tracked.person, index, body, camera));
  if (tracked.body) json["body"] = body_json(*tracked.body, body);
  if (!tracked.smoothed.empty()) json["smoothed"] = joints_json(tracked.smoothed, body, camera);
  return json;
}

Json floor_json(const std::optional<FloorView>& floor) {
  if (!floor) return {};
  return {{"up", xyz_json(floor->up)},
          {"height_m", rounded(floor->height_m)},
          {"tilt_degrees", rounded(kDegrees * static_cast<double>(floor->tilt_rad), 10)},
          {"roll_degrees", rounded(kDegrees * static_cast<double>(floor->roll_rad), 10)}};
}

Json events_json(const std::vector<StanceEvent>& events) {
  Json list = Json::array();
  for (const StanceEvent& event : events) {
    list.push_back({{"id", event.id}, {"time_s", rounded(event.time_s, 1e6)}, {"stance", to_string(event.stance)}});
  }
  return list;
}

}  // namespace

std::string frame_json(const Frame& frame, const std::vector<Person>& people, const BodyModel& body,
                       std::optional<double> latency_ms) {
  Json list = Json::array();
  for (std::size_t i = 0; i < people.size(); ++i) list.push_back(person_json(people[i], i, body, frame.camera));
  Json json = frame_facts(frame, latency_ms);
  json["people"] = std::move(list);
  return line(json);
}

std::string tracked_frame_json(const Frame& frame, const TrackedFrame& tracked, const BodyModel& body,
                               std::optional<double> latency_ms) {
  Json list = Json::array();
  for (std::size_t i = 0; i < tracked.people.size(); ++i) {
    list.push_back(tracked_json(tracked.people[i], i, body, frame.camera));
  }
  Json json = frame_facts(frame, latency_ms);
  json["track_time_s"] = rounded(tracked.time_s, 1e6);
  json["floor"] = floor_json(tracked.floor);
  json["events"] = events_json(tracked.events);
  json["people"] = std::move(list);
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
