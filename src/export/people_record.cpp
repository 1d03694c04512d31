#include "export/people_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

/// Reads one line after the other. What is not as it should be is said with its path in the line.
class LineReader {
 public:
  LineReader(const std::string& source, const RecordOptions& options) : source_(source), options_(options) {}

  void read(std::string_view line) {
    ++line_;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) return;
    Json json;
    try {
      json = Json::parse(line);
    } catch (const Json::parse_error& e) {
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
    return static_cast<int>(read);
  }
  template <int kSize>
  Eigen::Matrix<double, kSize, 1> vector(const Json& value) const {
    if (!value.is_array() || value.size() != kSize) fail(fmt::format("{}: expected {} numbers", value.dump(), kSize));
    Eigen::Matrix<double, kSize, 1> read;
    for (int i = 0; i < kSize; ++i) read[i] = number(value.at(static_cast<std::size_t>(i)));
    return read;
  }
  Eigen::Quaterniond rotation(const Json& xyzw) const {
    const Eigen::Vector4d read = vector<4>(xyzw);
    if (read.norm() < 0.5) fail(fmt::format("{}: expected a quaternion of length 1", xyzw.dump()));
    return Eigen::Quaterniond(read[3], read[0], read[1], read[2]).normalized();
  }

  RecordedFrame frame_of(const Json& json) {
    RecordedFrame frame;
    frame.name = json.at("frame").get<std::string>();
    const char* time = json.contains("track_time_s") ? "track_time_s" : "time_s";
    const bool has_time = json.contains(time) && !json.at(time).is_null();
    frame.time_s = has_time ? number(json.at(time)) : static_cast<double>(record_.frames.size()) / options_.rate_hz;
    if (!record_.frames.empty() && frame.time_s < record_.frames.back().time_s) {
      fail("a time before that of the line before, expected rising times");
    }
    const Json& camera = json.at("camera");
    frame.camera = {whole_number(camera.at("width")),
                    whole_number(camera.at("height")),
                    static_cast<float>(number(camera.at("fx"))),
                    static_cast<float>(number(camera.at("fy"))),
                    static_cast<float>(number(camera.at("cx"))),
                    static_cast<float>(number(camera.at("cy")))};
    for (const Json& person : json.at("people")) frame.people.push_back(person_of(person));
    return frame;
  }

  RecordedPerson person_of(const Json& json) {
    RecordedPerson person;
    record_.followed = record_.followed || json.contains("id");
    person.id = whole_number(json.at(json.contains("id") ? "id" : "index"));
    person.score = number(json.at("score"));
    const Json& box = json.at("box_px");
    if (!box.empty()) {
      const Eigen::Vector4d read = vector<4>(box);
      std::copy_n(read.data(), 4, person.box_px.data());
    }
    const bool smoothed = options_.smoothed && json.contains("smoothed");
    const Json& sets = json.at(smoothed ? "smoothed" : "joints");
    if (record_.sets.empty()) name_joints(sets);
    for (std::size_t s = 0; s < record_.sets.size(); ++s) {
      const Json& set = sets.at(record_.sets[s]);
      std::vector<RecordedJoint>& joints = person.joints.emplace_back();
      for (const std::string& name : record_.joints[s]) joints.push_back(joint_of(set.at(name)));
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

  RecordedJoint joint_of(const Json& json) const {
    RecordedJoint joint;
    if (!json.at("xyz_m").is_null()) joint.at_m = vector<3>(json.at("xyz_m"));
    if (json.contains("px") && !json.at("px").is_null()) joint.px = vector<2>(json.at("px"));
    joint.confidence = number(json.at("confidence"));
    joint.state = json.at("state").get<std::string>();
    return joint;
  }

  void add_body(const Json& json, RecordedPerson& person) {
    const Json& bones = json.at("bones");
    if (record_.bones.empty()) {
      for (const auto& [name, unused] : bones.items()) record_.bones.push_back(name);
    }
    for (const std::string& name : record_.bones) {
      const Json& bone = bones.at(name);
      person.bones.push_back(
          {vector<3>(bone.at("head_m")), vector<3>(bone.at("tail_m")), rotation(bone.at("global_xyzw"))});
    }
    if (!json.contains("joint_rotations_xyzw")) return;
    for (std::size_t s = 0; s < record_.sets.size(); ++s) {
      if (!json.at("joint_rotations_xyzw").contains(record_.sets[s])) continue;
      const Json& set = json.at("joint_rotations_xyzw").at(record_.sets[s]);
      for (const std::string& name : record_.joints[s]) {
        person.rotations[s].push_back(set.contains(name) ? std::optional(rotation(set.at(name))) : std::nullopt);
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
    reader.read(lines.substr(0, end));
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return reader.finish();
}

}  // namespace vesalius
