#include "synth/body/rig_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "synth/text/text_scanner.h"
#include "vesalius/base/toml_reader.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::string_view kMakeHumanRig =
#include "makehuman_rig.inc"
    ;

// No real map is nearly as long as this limit.
constexpr std::size_t kMostBytes = std::size_t{1} << 14;

/// TomlReader with what maps of rigs need: names, keys that may be missing, tables of a kind.
class MapReader : public TomlReader {
 public:
  using TomlReader::TomlReader;

  std::string name(const toml::table& table, std::string_view key) const {
    std::string value = string(need(table, key), key);
    if (value.empty() || shown(value) != value) {
      fail(table, fmt::format("{}: expected a name of at most 40 characters", key));
    }
    return value;
  }
  std::string name_or_empty(const toml::table& table, std::string_view key) const {
    return table.contains(key) ? name(table, key) : "";
  }
  bool boolean_or_false(const toml::table& table, std::string_view key) const {
    return table.contains(key) && boolean(table, key);
  }
  /// Returns the tables of an array of tables; none if the key is missing.
  std::vector<const toml::table*> tables(const toml::table& root, std::string_view key) const {
    std::vector<const toml::table*> found;
    const toml::node* node = root.get(key);
    if (node == nullptr) return found;
    if (!node->is_array_of_tables()) fail(*node, fmt::format("{}: expected tables [[{}]]", key, key));
    for (const toml::node& each : *node->as_array()) found.push_back(each.as_table());
    return found;
  }
};

/// Replaces the star by "l_" or "r_" for bones of poses, and by ".L" or ".R" for those of the rig.
std::string on_side(const std::string& text, bool left) {
  std::string out = text;
  if (out.starts_with("*_")) out.front() = left ? 'l' : 'r';
  if (out.ends_with(".*")) out.back() = left ? 'L' : 'R';
  return out;
}

/// Runs `work(left)` for both sides, or once if the table names no sides.
template <class F>
void for_sides(const std::string& name, F&& work) {
  work(true);
  if (on_side(name, true) != name) work(false);
}

Bone bone_named(const MapReader& reader, const toml::table& table, std::string_view key, bool left) {
  const std::string name = on_side(reader.name(table, key), left);
  const int found = find_bone(name);
  if (found < 0) reader.fail(table, fmt::format("{}: no bone of poses is called \"{}\"", key, name));
  return static_cast<Bone>(found);
}

RigMap::Rest read_rest(const MapReader& reader, const toml::table& table) {
  const std::string rest = reader.name(table, "rest");
  if (rest == "keep") return RigMap::Rest::keep;
  if (rest == "straighten") return RigMap::Rest::straighten;
  if (rest == "follow") return RigMap::Rest::follow;
  reader.fail(table, fmt::format("rest \"{}\": expected keep, straighten or follow", rest));
}

void read_bones(const MapReader& reader, const toml::table& root, RigMap& map) {
  for (const toml::table* table : reader.tables(root, "bone")) {
    reader.expect_keys(*table, {"bone", "joint", "tail", "rest"});
    for_sides(reader.name(*table, "bone"), [&](bool left) {
      RigMap::Joint& joint = map.bones[index(bone_named(reader, *table, "bone", left))];
      if (!joint.joint.empty()) reader.fail(*table, "bone: listed twice");
      joint.joint = on_side(reader.name(*table, "joint"), left);
      joint.tail = on_side(reader.name_or_empty(*table, "tail"), left);
      joint.rest = read_rest(reader, *table);
    });
  }
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const Bone bone = static_cast<Bone>(b);
    if (map.bones[b].joint.empty()) throw Error(fmt::format("{}: no [[bone]] for {}", map.name, bone_name(bone)));
    const bool last = bone == Bone::head || bone_name(bone).ends_with("_hand") || bone_name(bone).ends_with("_foot");
    if (last == map.bones[b].tail.empty()) {
      throw Error(fmt::format("{}: [[bone]] {}: expected {}", map.name, bone_name(bone),
                              last ? "a tail" : "no tail: the next bone begins there"));
    }
  }
}

void read_follows(const MapReader& reader, const toml::table& root, RigMap& map) {
  for (const toml::table* table : reader.tables(root, "follow")) {
    reader.expect_keys(*table, {"rig", "from", "to", "blend", "twist"});
    const std::string rig = reader.name(*table, "rig");
    for_sides(rig, [&](bool left) {
      RigMap::Follow follow;
      follow.rig = on_side(rig, left);
      follow.from = bone_named(reader, *table, "from", left);
      follow.to = table->contains("to") ? bone_named(reader, *table, "to", left) : follow.from;
      follow.blend = reader.number_or_zero(*table, "blend", 0.0, 1.0);
      follow.twist = reader.boolean_or_false(*table, "twist");
      map.follows.push_back(follow);
    });
  }
}

void read_fingers(const MapReader& reader, const toml::table& root, RigMap& map) {
  for (const toml::table* table : reader.tables(root, "finger")) {
    reader.expect_keys(*table, {"rig", "degrees", "across"});
    const std::string rig = reader.name(*table, "rig");
    if (on_side(rig, true) == rig) reader.fail(*table, "rig: expected a name that ends in \".*\"");
    const float radians = reader.number_or_zero(*table, "degrees", -180.0, 180.0) * std::numbers::pi_v<float> / 180.F;
    const float across = reader.number_or_zero(*table, "across", 0.0, 10.0);
    for (const bool left : {true, false}) {
      map.fingers.push_back({on_side(rig, left), left ? Grip::left : Grip::right, radians, across});
    }
  }
  if (map.fingers.empty()) return;
  const toml::table* knuckles = root["knuckles"].as_table();
  if (knuckles == nullptr) throw Error(fmt::format("{}: fingers without a table [knuckles]", map.name));
  reader.expect_keys(*knuckles, {"first", "last"});
  for (const bool left : {true, false}) {
    map.first_knuckle[left ? 0 : 1] = on_side(reader.name(*knuckles, "first"), left);
    map.last_knuckle[left ? 0 : 1] = on_side(reader.name(*knuckles, "last"), left);
  }
}

int find(const std::vector<SkeletonBone>& skeleton, const std::string& name, const RigMap& map) {
  const auto found = std::ranges::find(skeleton, name, &SkeletonBone::name);
  if (found == skeleton.end()) {
    throw Error(fmt::format("{}: the skeleton has no bone \"{}\"", map.name, shown(name)));
  }
  return int(found - skeleton.begin());
}

void map_follows(const std::vector<SkeletonBone>& skeleton, const RigMap& map, std::vector<RigBone>& bones) {
  std::vector<const RigMap::Follow*> follows(skeleton.size(), nullptr);
  for (const RigMap::Follow& f : map.follows) follows[find(skeleton, f.rig, map)] = &f;
  for (std::size_t b = 0; b < skeleton.size(); ++b) {
    RigBone& bone = bones[b];
    bone.name = skeleton[b].name;
    bone.parent = skeleton[b].parent;
    if (follows[b] != nullptr) {
      bone.from = follows[b]->from;
      bone.to = follows[b]->to;
      bone.blend = follows[b]->blend;
      bone.twist_only = follows[b]->twist;
    } else if (bone.parent >= 0) {
      const RigBone& above = bones[bone.parent];
      bone.from = above.from;
      bone.to = above.to;
      bone.blend = above.blend;
      bone.twist_only = above.twist_only;
    } else {
      throw Error(fmt::format("{}: no [[follow]] for the root \"{}\"", map.name, shown(bone.name)));
    }
  }
}

/// Returns the turns from this body's rest pose to the T for each bone of the poses.
std::array<Eigen::Quaternionf, kBoneCount> rest_turns(const MappedRig& rig, const std::vector<Eigen::Vector3f>& heads,
                                                      const std::vector<Eigen::Vector3f>& tails) {
  std::array<Eigen::Quaternionf, kBoneCount> turns;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const Bone bone = static_cast<Bone>(b);
    const Eigen::Quaternionf above = bone == Bone::pelvis ? Eigen::Quaternionf::Identity() : turns[index(parent(bone))];
    turns[b] = rig.rest[b] == RigMap::Rest::keep ? Eigen::Quaternionf::Identity() : above;
    if (rig.rest[b] != RigMap::Rest::straighten) continue;
    const Eigen::Vector3f& head = heads[rig.rig_of[b]];
    const Eigen::Vector3f& tail = rig.tail_of[b] < 0 ? heads[rig.rig_of[b + 1]] : tails[rig.tail_of[b]];
    turns[b] = Eigen::Quaternionf::FromTwoVectors(above * (tail - head), rest_direction(bone)) * above;
  }
  return turns;
}

/// Returns the axis about which a finger bone turns towards the palm.
Eigen::Vector3f curl_axis(const MappedRig& rig, const MappedRig::Finger& finger,
                          const std::vector<Eigen::Vector3f>& heads, const std::vector<Eigen::Vector3f>& tails) {
  const int b = finger.bone;
  const bool left = rig.bones[b].grip == Grip::left;
  const auto head = [&](int bone) -> const Eigen::Vector3f& { return heads[bone]; };
  const Eigen::Vector3f& wrist = head(rig.rig_of[index(left ? Bone::l_hand : Bone::r_hand)]);
  const Eigen::Vector3f& first = head(rig.first_knuckle[left ? 0 : 1]);
  const Eigen::Vector3f across = (head(rig.last_knuckle[left ? 0 : 1]) - first).normalized();
  const Eigen::Vector3f along = first - wrist;
  const Eigen::Vector3f palm = (left ? across.cross(along) : along.cross(across)).normalized();
  const Eigen::Vector3f axis = (tails[b] - heads[b]).cross(palm + finger.across * across);
  return axis.norm() > 1e-9F ? Eigen::Vector3f(axis.normalized()) : Eigen::Vector3f::UnitZ();
}

}  // namespace

RigMap parse_rig_map(std::string_view toml, const std::string& name) {
  if (toml.size() > kMostBytes) {
    throw Error(fmt::format("{}: {} bytes, expected at most {}", name, toml.size(), kMostBytes));
  }
  const MapReader reader(name);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"bone", "follow", "knuckles", "finger"});
  RigMap map;
  map.name = name;
  read_bones(reader, root, map);
  read_follows(reader, root, map);
  read_fingers(reader, root, map);
  return map;
}

const RigMap& makehuman_rig_map() {
  static const RigMap map = parse_rig_map(kMakeHumanRig, "makehuman_default.toml");
  return map;
}

MappedRig map_rig(const std::vector<SkeletonBone>& skeleton, const RigMap& map) {
  MappedRig rig;
  rig.bones.resize(skeleton.size());
  map_follows(skeleton, map, rig.bones);
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    rig.rig_of[b] = find(skeleton, map.bones[b].joint, map);
    rig.tail_of[b] = map.bones[b].tail.empty() ? -1 : find(skeleton, map.bones[b].tail, map);
    rig.rest[b] = map.bones[b].rest;
  }
  for (const RigMap::Finger& finger : map.fingers) {
    const int bone = find(skeleton, finger.rig, map);
    rig.bones[bone].grip = finger.hand;
    rig.bones[bone].curl_rad = finger.radians;
    rig.fingers.push_back({bone, finger.across});
  }
  if (map.fingers.empty()) return rig;
  for (std::size_t side = 0; side < 2; ++side) {
    rig.first_knuckle[side] = find(skeleton, map.first_knuckle[side], map);
    rig.last_knuckle[side] = find(skeleton, map.last_knuckle[side], map);
  }
  return rig;
}

std::vector<RigBone> fit_rig(const MappedRig& rig, const std::vector<Eigen::Vector3f>& heads,
                             const std::vector<Eigen::Vector3f>& tails) {
  const auto turns = rest_turns(rig, heads, tails);
  std::vector<RigBone> bones = rig.bones;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    bones[b].head = heads[b];
    bones[b].tail = tails[b];
    const Eigen::Quaternionf& from = turns[index(bones[b].from)];
    bones[b].t_from_rest = from.slerp(bones[b].blend, turns[index(bones[b].to)]);
  }
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    if (rig.tail_of[b] >= 0) {
      bones[rig.rig_of[b]].tail = tails[rig.tail_of[b]];
    }
  }
  for (const MappedRig::Finger& finger : rig.fingers) {
    bones[finger.bone].curl_axis = curl_axis(rig, finger, heads, tails);
  }
  return bones;
}

}  // namespace vesalius::synth
