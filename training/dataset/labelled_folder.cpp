#include "dataset/labelled_folder.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "dataset/dataset_shard.h"
#include "dataset/labelled_frame_codec.h"
#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "io/files/data_file.h"
#include "io/files/extrinsics_file.h"
#include "io/sources/folder_source.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Points = std::vector<Eigen::Vector3f>;

constexpr std::size_t kMaxTruthBytes = std::size_t{1} << 24;

/// Reads a point from [x, y, z]. If `or_null` is true, null is allowed and gives NaN.
Eigen::Vector3f point_of(const Json& json, bool or_null, const std::string& what) {
  if (or_null && json.is_null()) return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  if (!json.is_array() || json.size() != 3) throw Error(what + ": expected [x, y, z] in metres");
  Eigen::Vector3f point;
  for (int axis = 0; axis < 3; ++axis) {
    if (!json[axis].is_number()) throw Error(what + ": expected [x, y, z] in metres");
    point[axis] = json[axis].get<float>();
  }
  return point;
}

std::string text_of(const Json& json, const std::string& what) {
  if (!json.is_string()) throw Error(what + ": expected a word");
  return json.get<std::string>();
}

const Json& member(const Json& json, const std::string& key, const std::string& expected) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  if (found == json.end()) throw Error(fmt::format("no \"{}\", expected {}", key, expected));
  return *found;
}

Points parts_of(const Json& person, const BodyModel& body) {
  const Json& parts = member(person, "parts_m", "the centres of all parts");
  Points points;
  for (const BodyPart& part : body.parts) {
    points.push_back(point_of(member(parts, part.name, "every part of body.toml"), true, part.name));
  }
  return points;
}

double number_of(const Json& json, const std::string& what) {
  if (!json.is_number()) throw Error(what + ": expected a number");
  return json.get<double>();
}

/// Reads what is known about time and camera.
void read_circumstances(const Json& json, LabelledFrame& labelled) {
  const auto with = [&](const char* key, const auto& use) {
    const auto found = json.find(key);
    if (found != json.end()) use(*found);
  };
  with("up", [&](const Json& up) { labelled.up = point_of(up, false, "up"); });
  with("time_s", [&](const Json& time) { labelled.frame.time_s = number_of(time, "time_s"); });
  with("camera_height_m",
       [&](const Json& height) { labelled.camera_height_m = float(number_of(height, "camera_height_m")); });
  with("world_from_camera",
       [&](const Json& pose) { labelled.world_from_camera = parse_pose(pose, "world_from_camera"); });
}

/// Reads clips.json, if it is there.
ClipLayout read_clips(const std::string& folder) {
  const std::string path = (fs::path(folder) / "clips.json").string();
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  const Json json = Json::parse(read_file(path, kMaxTruthBytes), nullptr, false);
  ClipLayout clips;
  with_context(path, [&] {
    const double frames = number_of(member(json, "frames_per_clip", "a number of frames"), "frames_per_clip");
    clips.rate_hz = number_of(member(json, "rate_hz", "frames a second"), "rate_hz");
    if (!(frames >= 1.0 && frames <= 1e9)) throw Error("frames_per_clip: expected 1 to 1000000000");
    if (!(clips.rate_hz > 0.0 && clips.rate_hz <= kHighestRate_hz)) {
      throw Error(fmt::format("rate_hz: expected more than 0 and at most {}", kHighestRate_hz));
    }
    clips.frames_per_clip = static_cast<std::uint32_t>(frames);
  });
  return clips;
}

void read_people(const std::string& path, const BodyModel& body, LabelledFrame& labelled) {
  const Json json = Json::parse(read_file(path, kMaxTruthBytes), nullptr, false);
  with_context(path, [&] {
    const Json& people = member(json, "people", "a JSON object with a list of people");
    if (!people.is_array()) throw Error("people: expected a list");
    read_circumstances(json, labelled);
    for (const Json& person : people) {
      labelled.parts.push_back(parts_of(person, body));
      const auto posture = person.find("posture");
      if (posture != person.end()) labelled.postures.push_back(text_of(*posture, "posture"));
      const auto joints = person.find("joints_m");
      if (joints == person.end() || !joints->is_object()) continue;
      Points& points = labelled.joints.emplace_back();
      for (const auto& [name, point] : joints->items()) points.push_back(point_of(point, false, name));
    }
  });
}

/// Returns the names of the joints in a frame's truth; none for a file that cannot be used, which `read` will name.
std::vector<std::string> joint_names_in(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return {};
  const Json json = Json::parse(read_file(path, kMaxTruthBytes), nullptr, false);
  const Json people = json.is_object() ? json.value("people", Json::array()) : Json::array();
  std::vector<std::string> names;
  if (!people.is_array() || people.empty() || !people[0].is_object()) return names;
  const Json joints = people[0].value("joints_m", Json::object());
  if (!joints.is_object()) return names;
  for (const auto& [name, point] : joints.items()) names.push_back(name);
  return names;
}

std::string body_path(const std::string& folder) { return (fs::path(folder) / "body.toml").string(); }

/// Rounds to a tenth of a millimetre, which keeps the text short.
double rounded(float value) { return std::round(value * 1e4) / 1e4; }

Json point_json(const Eigen::Vector3f& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

Json parts_json(const std::vector<Eigen::Vector3f>& parts, const BodyModel& body) {
  Json json = Json::object();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    json[body.parts[p].name] = parts[p].hasNaN() ? Json() : point_json(parts[p]);  // null: the body lacks the part
  }
  return json;
}

std::string truth_json(const LabelledFrame& labelled, const BodyModel& body, const std::vector<std::string>& joints) {
  Json people = Json::array();
  for (std::size_t i = 0; i < labelled.parts.size(); ++i) {
    Json person = {{"index", i}, {"parts_m", parts_json(labelled.parts[i], body)}};
    if (!labelled.joints.empty()) {
      for (std::size_t j = 0; j < joints.size(); ++j) person["joints_m"][joints[j]] = point_json(labelled.joints[i][j]);
    }
    if (!labelled.postures.empty()) person["posture"] = labelled.postures[i];
    people.push_back(std::move(person));
  }
  Json json = {{"frame", labelled.frame.name}, {"people", std::move(people)}};
  if (labelled.frame.time_s) json["time_s"] = *labelled.frame.time_s;
  if (labelled.camera_height_m) json["camera_height_m"] = *labelled.camera_height_m;
  if (labelled.world_from_camera) json["world_from_camera"] = pose_json(*labelled.world_from_camera);
  if (labelled.up) json["up"] = {labelled.up->x(), labelled.up->y(), labelled.up->z()};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Of clips the rate is written, which gives times to whoever reads the folder as mere pictures.
WriteOptions options_for(const ClipLayout& clips) {
  WriteOptions options;
  if (clips.rate_hz > 0.0) options.frame_rate = float(clips.rate_hz);
  return options;
}

}  // namespace

bool is_labelled_folder(const std::string& path) {
  std::error_code ignored;
  for (const char* kind : {"depth", "labels", "person", "truth"}) {
    if (!fs::is_directory(fs::path(path) / kind, ignored)) return false;
  }
  return fs::is_regular_file(body_path(path), ignored);
}

LabelledFolder::LabelledFolder(const std::string& folder)
    : folder_(folder),
      body_(parse_body_model(read_file(body_path(folder)), body_path(folder))),
      clips_(read_clips(folder)),
      frames_(list_folder(folder, {})) {
  if (frames_.is_rectified())
    throw Error(folder + ": a distorted lens, expected labels of a pinhole camera (meta.json)");
  for (std::uint64_t i = 0; i < size() && joint_names_.empty(); ++i)
    joint_names_ = joint_names_in(file("truth", i, ".json"));
}

std::string LabelledFolder::file(const char* kind, std::uint64_t index, const char* extension) const {
  return (fs::path(folder_) / kind / (frames_.list().frames[index].name + extension)).string();
}

LabelledFrame LabelledFolder::read(std::uint64_t index, bool with_colour) const {
  LabelledFrame labelled;
  labelled.frame = frames_.read(index, with_colour);
  labelled.frame.up.reset();  // as in shards: it is truth
  labelled.labels = read_png8(file("labels", index, ".png"));
  labelled.person = read_png8(file("person", index, ".png"));
  read_people(file("truth", index, ".json"), body_, labelled);
  with_context(folder_ + ": frame " + labelled.frame.name, [&] { check_truth(labelled, body_.part_count()); });
  return labelled;
}

std::uint64_t LabelledFolder::content_hash() const {
  ByteWriter hashed;
  hashed.text(body_.toml);
  const Camera& camera = frames_.camera();
  for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) hashed.real(value);
  for (std::uint64_t i = 0; i < size(); ++i) {
    hashed.number(checksum_of(read_file(frames_.list().frames[i].depth)));
    hashed.number(checksum_of(read_file(file("labels", i, ".png"))));
    hashed.number(checksum_of(read_file(file("person", i, ".png"))));
    hashed.number(checksum_of(read_file(file("truth", i, ".json"))));
  }
  return checksum_of(hashed.bytes());
}

LabelledExporter::LabelledExporter(const std::string& folder, const BodyModel& body, std::vector<std::string> joints,
                                   const ClipLayout& clips)
    : folder_(folder),
      body_(body),
      joints_(std::move(joints)),
      frames_(make_frame_writer(FrameFormat::folder, folder, options_for(clips))) {
  for (const char* kind : {"labels", "person", "truth"}) {
    std::error_code error;
    fs::create_directories(fs::path(folder) / kind, error);
    if (error)
      throw Error(fmt::format("{}: folder cannot be made: {}", (fs::path(folder) / kind).string(), error.message()));
  }
  write_file_atomically((fs::path(folder) / "body.toml").string(), body.toml);
  if (clips.frames_per_clip == 0) return;
  const Json json = {{"frames_per_clip", clips.frames_per_clip}, {"rate_hz", clips.rate_hz}};
  write_file_atomically((fs::path(folder) / "clips.json").string(), json.dump(1) + "\n");
}

void LabelledExporter::write(const LabelledFrame& labelled) {
  const std::string& name = labelled.frame.name;
  with_context(folder_ + ": frame " + name, [&] {
    check_truth(labelled, body_.part_count());
    for (const auto& joints : labelled.joints) {
      if (joints.size() != joints_.size()) {
        throw Error(fmt::format("person with {} joints, expected {}", joints.size(), joints_.size()));
      }
    }
  });
  const auto path = [&](const char* kind, const char* extension) {
    return (fs::path(folder_) / kind / (name + extension)).string();
  };
  // The writer of frames would number the second one, and its truth would replace the first one's.
  if (fs::exists(path("truth", ".json"))) throw Error(fmt::format("{}: two frames named {}", folder_, name));
  Frame frame = labelled.frame;
  frame.up = labelled.up;
  frames_->write(frame);
  write_png(labelled.labels, path("labels", ".png"));
  write_png(labelled.person, path("person", ".png"));
  write_file_atomically(path("truth", ".json"), truth_json(labelled, body_, joints_));
}

void LabelledExporter::close() { frames_->close(); }

}  // namespace vesalius
