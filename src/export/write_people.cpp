#include "export/write_people.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "export/write_gltf.h"
#include "stream/json_numbers.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

/// Returns a text as a field of a table: in quotes where it needs them.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// Returns a number with so many decimals, without a minus before nothing.
double with_decimals(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale + 0.0;
}

/// With y up and z towards the camera.
Eigen::Vector3d with_y_up(const Eigen::Vector3d& optical) { return {optical.x(), -optical.y(), -optical.z()}; }

/// Returns the frames a second: the median of the times between them.
double rate_of(const std::vector<double>& times_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps.push_back(times_s[i] - times_s[i - 1]);
  std::erase_if(steps, [](double step) { return step <= 0.0; });
  if (steps.empty()) return 30.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return 1.0 / *middle;
}

}  // namespace

std::string to_csv(const PeopleRecord& record, std::size_t set) {
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "frame,time_s,person,score");
  for (const std::string& joint : record.joints[set]) {
    const std::string name = field(joint);
    fmt::format_to(to, ",{0}_x_m,{0}_y_m,{0}_z_m,{0}_confidence,{0}_state", name);
  }
  fmt::format_to(to, "\n");
  for (const RecordedFrame& frame : record.frames) {
    for (const RecordedPerson& person : frame.people) {
      fmt::format_to(to, "{},{:.6f},{},{:.4f}", field(frame.name), frame.time_s, person.id, person.person.score);
      for (const Joint& joint : person.person.joints[set]) {
        if (joint.state != State::none) {
          const Eigen::Vector3d place = rounded(joint.position);
          const Eigen::Vector3d at = record.upright ? with_y_up(place) : place;
          fmt::format_to(to, ",{:.4f},{:.4f},{:.4f}", at.x(), at.y(), at.z());
        } else {
          fmt::format_to(to, ",,,");
        }
        fmt::format_to(to, ",{:.4f},{}", joint.confidence, to_string(joint.state));
      }
      fmt::format_to(to, "\n");
    }
  }
  return fmt::to_string(out);
}

std::vector<int> people_in(const PeopleRecord& record) {
  std::set<int> ids;
  for (const RecordedFrame& frame : record.frames) {
    for (const RecordedPerson& person : frame.people) ids.insert(person.id);
  }
  return {ids.begin(), ids.end()};
}

std::string to_trc(const PeopleRecord& record, std::size_t set, int person, const std::string& name) {
  std::vector<const RecordedPerson*> of_frame;
  std::vector<double> times_s;
  std::size_t known = 0;  // rows up to the last with the person
  for (const RecordedFrame& frame : record.frames) {
    const auto found = std::ranges::find(frame.people, person, &RecordedPerson::id);
    if (found == frame.people.end() && of_frame.empty()) continue;
    of_frame.push_back(found != frame.people.end() ? &*found : nullptr);
    times_s.push_back(frame.time_s);
    if (found != frame.people.end()) known = of_frame.size();
  }
  if (of_frame.empty()) throw Error(fmt::format("person {} is in no frame", person));
  of_frame.resize(known);
  times_s.resize(known);
  const double rate = rate_of(times_s);
  const std::vector<std::string>& joints = record.joints[set];
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "PathFileType\t4\t(X/Y/Z)\t{}\n", name);
  fmt::format_to(
      to, "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n");
  fmt::format_to(to, "{0:.2f}\t{0:.2f}\t{1}\t{2}\tmm\t{0:.2f}\t1\t{1}\n", rate, known, joints.size());
  fmt::format_to(to, "Frame#\tTime");
  for (const std::string& joint : joints) fmt::format_to(to, "\t{}\t\t", joint);
  fmt::format_to(to, "\n\t");
  for (std::size_t j = 1; j <= joints.size(); ++j) fmt::format_to(to, "\tX{0}\tY{0}\tZ{0}", j);
  fmt::format_to(to, "\n\n");
  for (std::size_t i = 0; i < known; ++i) {
    fmt::format_to(to, "{}\t{:.6f}", i + 1, times_s[i] - times_s.front());
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Joint joint = of_frame[i] != nullptr ? of_frame[i]->person.joints[set][j] : Joint{};
      if (joint.state == State::none) {
        fmt::format_to(to, "\t\t\t");
        continue;
      }
      const Eigen::Vector3d at = 1000.0 * with_y_up(rounded(joint.position));
      fmt::format_to(to, "\t{:.3f}\t{:.3f}\t{:.3f}", at.x(), at.y(), at.z());
    }
    fmt::format_to(to, "\n");
  }
  return fmt::to_string(out);
}

std::string to_coco(const PeopleRecord& record, std::size_t set) {
  Json images = Json::array(), annotations = Json::array();
  for (std::size_t f = 0; f < record.frames.size(); ++f) {
    const RecordedFrame& frame = record.frames[f];
    images.push_back({{"id", f + 1},
                      {"file_name", frame.picture.empty() ? frame.name + ".png" : frame.picture},
                      {"width", frame.camera.width},
                      {"height", frame.camera.height}});
    for (const RecordedPerson& person : frame.people) {
      Json keypoints = Json::array();
      int visible = 0;
      for (std::size_t j = 0; j < record.joints[set].size(); ++j) {
        const std::optional<Eigen::Vector2d>& px = person.px[set][j];
        const int visibility = !px ? 0 : person.person.joints[set][j].state == State::observed ? 2 : 1;
        keypoints.push_back(px ? with_decimals(px->x(), 2) : 0.0);
        keypoints.push_back(px ? with_decimals(px->y(), 2) : 0.0);
        keypoints.push_back(visibility);
        visible += px ? 1 : 0;
      }
      const Box& b = person.person.box;
      const std::array<double, 4> box{double(b.u), double(b.v), double(b.width), double(b.height)};
      annotations.push_back({{"id", annotations.size() + 1},
                             {"image_id", f + 1},
                             {"category_id", 1},
                             {"keypoints", std::move(keypoints)},
                             {"num_keypoints", visible},
                             {"bbox", box},
                             {"area", box[2] * box[3]},
                             {"iscrowd", 0},
                             {"score", rounded(person.person.score)},
                             {"track_id", person.id}});
    }
  }
  const Json category{{"id", 1},
                      {"name", "person"},
                      {"supercategory", "person"},
                      {"keypoints", record.joints[set]},
                      {"skeleton", Json::array()}};
  return dumped({{"info", {{"description", "vesalius " VESALIUS_VERSION}}},
                 {"images", std::move(images)},
                 {"annotations", std::move(annotations)},
                 {"categories", Json::array({category})}});
}

namespace {

/// Joints of k4abt32 as Azure Kinect's headers call them, without K4ABT_JOINT_.
std::string k4abt_name(std::string name) {
  const bool left = name.starts_with("l_"), right = name.starts_with("r_");
  if (left || right) name.erase(0, 2);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return left ? name + "_LEFT" : right ? name + "_RIGHT" : name;
}

/// Pairs of a joint's parent and the joint, as Azure Kinect's documentation has them.
constexpr std::array<const char*, 62> kK4abtBones{
    "pelvis",      "spine_naval", "spine_naval", "spine_chest", "spine_chest", "neck",       "neck",       "head",
    "head",        "nose",        "head",        "l_eye",       "head",        "l_ear",      "head",       "r_eye",
    "head",        "r_ear",       "spine_chest", "l_clavicle",  "l_clavicle",  "l_shoulder", "l_shoulder", "l_elbow",
    "l_elbow",     "l_wrist",     "l_wrist",     "l_hand",      "l_hand",      "l_handtip",  "l_wrist",    "l_thumb",
    "spine_chest", "r_clavicle",  "r_clavicle",  "r_shoulder",  "r_shoulder",  "r_elbow",    "r_elbow",    "r_wrist",
    "r_wrist",     "r_hand",      "r_hand",      "r_handtip",   "r_wrist",     "r_thumb",    "pelvis",     "l_hip",
    "l_hip",       "l_knee",      "l_knee",      "l_ankle",     "l_ankle",     "l_foot",     "pelvis",     "r_hip",
    "r_hip",       "r_knee",      "r_knee",      "r_ankle",     "r_ankle",     "r_foot"};

}  // namespace

std::string to_k4abt(const PeopleRecord& record, const std::string& source) {
  const std::size_t set = record.find_set("k4abt32");
  Json frames = Json::array(), names = Json::array(), bones = Json::array();
  for (const std::string& joint : record.joints[set]) names.push_back(k4abt_name(joint));
  for (std::size_t i = 0; i < kK4abtBones.size(); i += 2) {
    bones.push_back({k4abt_name(kK4abtBones[i]), k4abt_name(kK4abtBones[i + 1])});
  }
  for (std::size_t f = 0; f < record.frames.size(); ++f) {
    const RecordedFrame& frame = record.frames[f];
    Json bodies = Json::array();
    for (const RecordedPerson& person : frame.people) {
      Json positions = Json::array(), orientations = Json::array();
      for (std::size_t j = 0; j < record.joints[set].size(); ++j) {
        const Eigen::Vector3d mm = 1000.0 * rounded(person.person.joints[set][j].position);
        positions.push_back({with_decimals(mm.x(), 3), with_decimals(mm.y(), 3), with_decimals(mm.z(), 3)});
        const bool turned = j < person.rotations[set].size() && person.rotations[set][j].has_value();
        const Eigen::Quaterniond q = turned ? *person.rotations[set][j] : Eigen::Quaterniond::Identity();
        orientations.push_back(
            {with_decimals(q.w(), 6), with_decimals(q.x(), 6), with_decimals(q.y(), 6), with_decimals(q.z(), 6)});
      }
      bodies.push_back({{"body_id", person.id},
                        {"joint_positions", std::move(positions)},
                        {"joint_orientations", std::move(orientations)}});
    }
    frames.push_back({{"frame_id", f},
                      {"timestamp_usec", static_cast<std::int64_t>(std::llround(1e6 * frame.time_s))},
                      {"num_bodies", frame.people.size()},
                      {"bodies", std::move(bodies)}});
  }
  return dumped({{"k4abt_sdk_version", "vesalius " VESALIUS_VERSION},
                 {"source_file", source},
                 {"joint_names", std::move(names)},
                 {"bone_list", std::move(bones)},
                 {"frames", std::move(frames)}});
}

namespace {

/// Writes a bone of BVH's hierarchy and all that hang on it.
void append_bone(const MovingSkeleton& skeleton, std::size_t bone, int depth, std::string& out,
                 std::vector<std::size_t>& order) {
  const MovingSkeleton::Bone& b = skeleton.bones[bone];
  const std::string indent(static_cast<std::size_t>(depth), '\t');
  const auto offset = [&](const std::string& before, const Eigen::Vector3d& m) {
    out += fmt::format("{}OFFSET {:.6f} {:.6f} {:.6f}\n", before, 100.0 * m.x(), 100.0 * m.y(), 100.0 * m.z());
  };
  order.push_back(bone);
  out += fmt::format("{}{} {}\n{}{{\n", indent, b.parent < 0 ? "ROOT" : "JOINT", b.name, indent);
  offset(indent + "\t", b.offset_m);
  out += indent + (b.parent < 0 ? "\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
                                : "\tCHANNELS 3 Zrotation Xrotation Yrotation\n");
  for (std::size_t child = bone + 1; child < skeleton.bones.size(); ++child) {
    if (skeleton.bones[child].parent == int(bone)) append_bone(skeleton, child, depth + 1, out, order);
  }
  if (b.ends) {
    out += indent + "\tEnd Site\n" + indent + "\t{\n";
    offset(indent + "\t\t", b.tail_m);
    out += indent + "\t}\n";
  }
  out += indent + "}\n";
}

}  // namespace

std::string to_bvh(const MovingSkeleton& skeleton) {
  std::string out = "HIERARCHY\n";
  std::vector<std::size_t> order;
  append_bone(skeleton, 0, 0, out, order);
  std::vector<double> times_s;
  for (const MovingSkeleton::Pose& pose : skeleton.poses) times_s.push_back(pose.time_s);
  out += fmt::format("MOTION\nFrames: {}\nFrame Time: {:.6f}\n", skeleton.poses.size(), 1.0 / rate_of(times_s));
  for (const MovingSkeleton::Pose& pose : skeleton.poses) {
    const Eigen::Vector3d root = 100.0 * pose.root_m;
    out += fmt::format("{:.4f} {:.4f} {:.4f}", root.x(), root.y(), root.z());
    for (const std::size_t bone : order) {
      const Eigen::Vector3d angles = zxy_degrees(pose.local[bone]);
      out += fmt::format(" {:.4f} {:.4f} {:.4f}", angles[0], angles[1], angles[2]);
    }
    out += "\n";
  }
  return out;
}

namespace {

std::vector<int> people_with_bodies(const PeopleRecord& record) {
  std::vector<int> ids;
  for (const MovingSkeleton& skeleton : moving_skeletons(record, std::nullopt)) ids.push_back(skeleton.id);
  return ids;
}

}  // namespace

const std::vector<ExportFormat>& export_formats() {
  using Record = const PeopleRecord&;
  using Request = const ExportRequest&;
  static const std::vector<ExportFormat> kFormats{
      {"csv", ".csv", "k4abt32", false, true, nullptr, [](Record r, Request q) { return to_csv(r, q.set); }},
      {"trc", ".trc", "k4abt32", true, true, people_in,
       [](Record r, Request q) { return to_trc(r, q.set, *q.person, q.name); }},
      {"bvh", ".bvh", "", true, true, people_with_bodies,
       [](Record r, Request q) { return to_bvh(moving_skeletons(r, q.person)[0]); }},
      {"glb", ".glb", "", true, true, nullptr,
       [](Record r, Request q) { return to_glb(moving_skeletons(r, q.person)); }},
      {"coco", "", "coco17", false, false, nullptr, [](Record r, Request q) { return to_coco(r, q.set); }},
      {"k4abt", "", "", false, false, nullptr, [](Record r, Request q) { return to_k4abt(r, q.source); }}};
  return kFormats;
}

}  // namespace vesalius
