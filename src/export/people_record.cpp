#include "export/people_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "stream/json_numbers.h"
#include "stream/person_fields.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

/// Reads one line after the other. What is not as it should be is said with its path in the line.
class LineReader {
 public:
  LineReader(std::string source, const RecordOptions& options) : source_(std::move(source)), options_(options) {}

  /// `ends` says whether the line has its end: whoever was killed while writing leaves one without.
  void read(std::string_view line, bool ends) {
    ++line_;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) return;
    Json json;
    try {
      json = Json::parse(line);
    } catch (const Json::parse_error& e) {
      if (!ends && !record_.frames.empty()) {
        record_.notes.push_back(fmt::format("{}: line {} is cut and left out", source_, line_));
        return;
      }
      fail(fmt::format("no JSON from byte {} on, expected a line of vesalius detect --json", e.byte));
    } catch (const Json::exception& e) {
      fail(reason(e));
    }
    if (!json.is_object()) fail("expected an object, a line of vesalius detect --json");
    if (!json.contains("frame")) return;  // the closing line
    try {
      record_.frames.push_back(frame_of(json));
    } catch (const Json::exception& e) {
      fail(reason(e));
    }
  }

  PeopleRecord finish() {
    if (record_.frames.empty()) throw Error(source_ + ": no frames, expected lines of vesalius detect --json");
    return std::move(record_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{}: line {}: {}", source_, line_, what));
  }

  /// What the library says, without its own number for it.
  static std::string reason(const Json::exception& e) {
    const std::string what = e.what();
    const std::size_t end = what.find("] ");
    return (end == std::string::npos ? what : what.substr(end + 2)) + "; expected a line of vesalius detect --json";
  }

  double number(const Json& value) const {
    constexpr double kMost = 1e12;  // seconds since 1970 have ten digits
    const auto read = value.get<double>();
    if (!(std::abs(read) <= kMost)) fail(fmt::format("{}: expected at most 10^12", value.dump()));
    return read;
  }
  int whole_number(const Json& value) const {
    const double read = number(value);
    if (read != std::floor(read) || std::abs(read) > std::numeric_limits<int>::max()) {
      fail(fmt::format("{}: expected a whole number", value.dump()));
    }
    return int(read);
  }
  template <int kSize>
  Eigen::Matrix<double, kSize, 1> vector(const Json& value) const {
    if (!value.is_array() || value.size() != kSize) fail(fmt::format("{}: expected {} numbers", value.dump(), kSize));
    Eigen::Matrix<double, kSize, 1> read;
    for (int i = 0; i < kSize; ++i) read[i] = number(value.at(static_cast<std::size_t>(i)));
    return read;
  }
  Eigen::Vector4d quaternion(const Json& xyzw) const {
    Eigen::Vector4d read = vector<4>(xyzw);
    if (read.norm() < 0.5) fail(fmt::format("{}: expected a quaternion of length 1", xyzw.dump()));
    return read;
  }

  void read_value(const Json& json, int& to) const { to = whole_number(json); }
  void read_value(const Json& json, bool& to) const { to = json.get<bool>(); }
  void read_value(const Json& json, float& to) const { to = float(number(json)); }
  void read_value(const Json& json, double& to) const { to = number(json); }
  void read_value(const Json& json, Eigen::Vector3f& to) const { to = vector<3>(json).cast<float>(); }
  void read_value(const Json& json, Eigen::Quaternionf& to) const { to.coeffs() = quaternion(json).cast<float>(); }
  void read_value(const Json& json, std::vector<float>& to) const {
    for (const Json& value : json) to.push_back(float(number(value)));
  }
  void read_value(const Json& json, Box& to) const {
    if (json.empty()) return;
    (void)vector<4>(json);
    to = {whole_number(json[0]), whole_number(json[1]), whole_number(json[2]), whole_number(json[3])};
  }
  template <class Enum>
  requires std::is_enum_v<Enum>
  void read_value(const Json& json, Enum& to) const {
    constexpr int kMostWords = 8;
    const auto word = json.get<std::string>();
    for (int i = 0; i < kMostWords; ++i) {
      if (to_string(to = static_cast<Enum>(i)) == word) return;
    }
    fail(fmt::format("{}: expected a word of vesalius detect --json", json.dump()));
  }
  /// Of other kinds nothing is exported.
  template <class Other>
  void read_value(const Json& /*json*/, Other& /*to*/) const {}

  /// Reads those fields that the line has: older lines have fewer.
  template <class Struct>
  void read_fields(const Json& json, Struct& to) const {
    visit_fields<Struct>([&](const auto& field) {
      const auto found = json.find(key_of(field));
      if (found != json.end()) read_value(*found, to.*field.member);
    });
  }

  RecordedFrame frame_of(const Json& json) {
    RecordedFrame frame;
    frame.name = json.at("frame").get<std::string>();
    const char* time = json.contains("track_time_s") ? "track_time_s" : "time_s";
    const bool has_time = json.contains(time) && !json.at(time).is_null();
    frame.time_s = has_time ? number(json.at(time)) : double(record_.frames.size()) / options_.rate_hz;
    if (!record_.frames.empty() && frame.time_s < record_.frames.back().time_s) {
      fail("a time before that of the line before, expected rising times");
    }
    const Json& camera = json.at("camera");
    frame.camera = {whole_number(camera.at("width")), whole_number(camera.at("height")),
                    float(number(camera.at("fx"))),   float(number(camera.at("fy"))),
                    float(number(camera.at("cx"))),   float(number(camera.at("cy")))};
    if (const auto floor = json.find("floor"); floor != json.end() && !floor->is_null()) {
      read_value(floor->at("up"), frame.floor.emplace().up);
      read_value(floor->at("height_m"), frame.floor->height_m);
      if (frame.floor->up.norm() < 0.5F) fail("floor: up: expected a vector of length 1");
    }
    for (const Json& person : json.at("people")) frame.people.push_back(person_of(person, frame.camera));
    return frame;
  }

  RecordedPerson person_of(const Json& json, const Camera& camera) {
    RecordedPerson person;
    read_fields<TrackedPerson>(json, person);
    read_fields<Person>(json, person.person);
    if (!json.contains("id")) person.id = whole_number(json.at("index"));
    const bool smoothed = options_.smoothed && json.contains("smoothed");
    const Json& sets = json.at(smoothed ? "smoothed" : "joints");
    if (record_.sets.empty()) name_joints(sets);
    for (std::size_t s = 0; s < record_.sets.size(); ++s) {
      const Json& set = sets.at(record_.sets[s]);
      person.person.joints.emplace_back();
      person.px.emplace_back();
      for (const std::string& name : record_.joints[s]) add_joint(set.at(name), camera, person);
    }
    person.rotations.resize(record_.sets.size());
    if (json.contains("body") && !json.at("body").is_null()) add_body(json.at("body"), person);
    return person;
  }

  void name_joints(const Json& sets) {
    for (const auto& [name, joints] : sets.items()) {
      record_.sets.push_back(name);
      std::vector<std::string>& names = record_.joints.emplace_back();
      for (const auto& [joint, unused] : joints.items()) names.push_back(joint);
    }
  }

  void add_joint(const Json& json, const Camera& camera, RecordedPerson& person) const {
    Joint& joint = person.person.joints.back().emplace_back();
    read_value(json.at("state"), joint.state);
    read_value(json.at("confidence"), joint.confidence);
    if (json.at("xyz_m").is_null()) {
      joint.state = State::none;
    } else {
      read_value(json.at("xyz_m"), joint.position);
    }
    auto& px = person.px.back().emplace_back();
    if (json.contains("px") && !json.at("px").is_null()) px = vector<2>(json.at("px"));
    const bool is_brief = !json.contains("px") && joint.state != State::none && joint.position.z() > 0.F;
    if (is_brief) px = camera.pixel(joint.position).cast<double>();
  }

  void add_body(const Json& json, RecordedPerson& person) {
    FittedBody& body = person.body.emplace();
    read_fields(json, body);
    const Json& bones = json.at("bones");
    if (record_.bones.empty()) {
      for (const auto& [name, unused] : bones.items()) record_.bones.push_back(name);
    }
    for (const std::string& name : record_.bones) {
      const Json& bone = bones.at(name);
      for (const char* key : {"head_m", "tail_m", "global_xyzw"}) (void)bone.at(key);  // there is none without
      read_fields(bone, body.bones.emplace_back());
    }
    if (!json.contains("joint_rotations_xyzw")) return;
    for (std::size_t s = 0; s < record_.sets.size(); ++s) {
      if (!json.at("joint_rotations_xyzw").contains(record_.sets[s])) continue;
      const Json& set = json.at("joint_rotations_xyzw").at(record_.sets[s]);
      for (const std::string& name : record_.joints[s]) {
        auto& rotation = person.rotations[s].emplace_back();
        if (set.contains(name)) rotation.emplace(quaternion(set.at(name))).normalize();
      }
    }
  }

  std::string source_;
  RecordOptions options_;
  int line_ = 0;
  PeopleRecord record_;
};

}  // namespace

std::size_t PeopleRecord::find_set(const std::string& name) const {
  const auto found = std::ranges::find(sets, name);
  if (found == sets.end()) {
    std::string known;
    for (const std::string& set : sets) known += (known.empty() ? "" : ", ") + set;
    throw UsageError(fmt::format("joint set \"{}\" is not in the recording, expected one of: {}", name, known));
  }
  return static_cast<std::size_t>(found - sets.begin());
}

PeopleRecord parse_people(std::string_view lines, const std::string& source, const RecordOptions& options) {
  LineReader reader(source, options);
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    reader.read(lines.substr(0, end), end < lines.size());
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return reader.finish();
}

}  // namespace vesalius
