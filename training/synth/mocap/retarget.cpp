#include "synth/mocap/retarget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/text/text_scanner.h"
#include "vesalius/base/toml_reader.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

// The TOML library frees nested tables by recursion. A text of this size cannot exhaust the stack.
constexpr std::size_t kMaxBytes = std::size_t{1} << 14;

struct Builtin {
  std::string_view toml;
  const char* name;
};

constexpr Builtin kBuiltin[] = {
#include "motion_conventions.inc"
};

std::string name_in(const TomlReader& reader, const toml::node& node, std::string_view what) {
  std::string name = reader.string(node, what);
  if (name.empty()) reader.fail(node, fmt::format("{}: expected a name", what));
  return name;
}

int bone_of(const TomlReader& reader, const toml::node& node, std::string_view name) {
  const int found = find_bone(name);
  if (found < 0) reader.fail(node, fmt::format("no bone is called {}", in_quotes(name)));
  return found;
}

BoneSource read_source(const TomlReader& reader, const toml::node& node, std::string_view bone) {
  const toml::table& table = reader.table(node, bone);
  reader.expect_keys(table, {"from", "rest"});
  BoneSource out;
  const toml::array& from = reader.array(table, "from");
  if (from.empty() || from.size() > 2) reader.fail(from, "from: expected an array of one or two joints");
  for (const toml::node& joint : from) out.from.push_back(name_in(reader, joint, "from"));
  const toml::node& rest = reader.need(table, "rest");
  const std::string rule = name_in(reader, rest, "rest");
  if (rule == "aim") {
    out.rest = RestRule::aim;
  } else if (rule != "same") {
    out.rest = RestRule::like;
    out.like = static_cast<Bone>(bone_of(reader, rest, rule));
  }
  return out;
}

void check_bone(const TomlReader& reader, const toml::node& bones, const MotionConvention& convention, std::size_t b) {
  const BoneSource& source = convention.bones[b];
  const std::string_view name = bone_name(static_cast<Bone>(b));
  if (source.from.empty()) reader.fail(bones, fmt::format("missing bone \"{}\"", name));
  if (source.rest == RestRule::aim && source.from.size() > 1) {
    reader.fail(bones, fmt::format("{}: rest \"aim\" needs a single joint", name));
  }
  if (source.rest == RestRule::like && convention.bones[index(source.like)].rest == RestRule::like) {
    reader.fail(
        bones, fmt::format(R"({}: rest names {}, expected a bone with "same" or "aim")", name, bone_name(source.like)));
  }
}

/// The joints of one bone in a given motion, and the turn that precedes theirs.
struct Source {
  int first = -1;
  int second = -1;  ///< -1 if only the first is used
  Eigen::Quaternionf source_from_t = Eigen::Quaternionf::Identity();
};

using Sources = std::array<Source, kBoneCount>;

/// Returns the name of a joint that the convention uses and the motion lacks; empty if there is none.
std::string missing_joint(const Motion& motion, const MotionConvention& convention) {
  for (const BoneSource& bone : convention.bones) {
    for (const std::string& joint : bone.from) {
      if (motion.find_joint(joint) < 0) return joint;
    }
  }
  return {};
}

/// Throws Error naming a joint that the motion lacks, or a bone with RestRule::aim whose joint has no direction.
void check_fit(const Motion& motion, const MotionConvention& convention) {
  const std::string missing = missing_joint(motion, convention);
  if (!missing.empty()) {
    throw Error(fmt::format("{}: no joint is called {}, which convention {} expects", motion.name, in_quotes(missing),
                            convention.name));
  }
  for (const BoneSource& bone : convention.bones) {
    if (bone.rest != RestRule::aim) continue;
    if (motion.joints[motion.find_joint(bone.from[0])].along.isZero()) {
      throw Error(fmt::format("{}: joint {} has no direction: expected a child apart from it", motion.name,
                              in_quotes(bone.from[0])));
    }
  }
}

Sources find_sources(const Motion& motion, const MotionConvention& convention) {
  Sources sources;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const BoneSource& bone = convention.bones[b];
    Source& source = sources[b];
    source.first = motion.find_joint(bone.from[0]);
    if (bone.from.size() > 1) source.second = motion.find_joint(bone.from[1]);
    if (bone.rest != RestRule::aim) continue;
    const MotionJoint& joint = motion.joints[source.first];
    source.source_from_t = Eigen::Quaternionf::FromTwoVectors(rest_direction(static_cast<Bone>(b)), joint.along);
  }
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const BoneSource& bone = convention.bones[b];
    if (bone.rest == RestRule::like) sources[b].source_from_t = sources[index(bone.like)].source_from_t;
  }
  return sources;
}

Pose pose_of(const Motion& motion, const Sources& sources, int frame) {
  std::array<Eigen::Quaternionf, kBoneCount> world;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const Source& source = sources[b];
    Eigen::Quaternionf q = motion.rotation(frame, source.first);
    if (source.second >= 0) q = q.slerp(0.5F, motion.rotation(frame, source.second));
    world[b] = q * source.source_from_t;
  }
  return from_world_rotations(world);
}

/// Returns the length of the leg at rest, from the hip to the ankle, in the motion's unit.
float leg_length(const Motion& motion, const Sources& sources) {
  const int hip = sources[index(Bone::l_thigh)].first;
  float length = 0.F;
  for (int j = sources[index(Bone::l_foot)].first; j >= 0 && j != hip; j = motion.joints[j].parent) {
    length += motion.joints[j].offset.norm();
  }
  if (!(length > 0.F) || !std::isfinite(length)) throw Error(motion.name + ": its legs have no length");
  return length;
}

/// Takes the heading out of a pelvis and returns it.
float take_heading(Eigen::Quaternionf& pelvis) {
  const float heading = 2.F * std::atan2(pelvis.y(), pelvis.w());
  pelvis = without_yaw(pelvis);
  return heading;
}

}  // namespace

MotionConvention parse_convention(std::string_view toml, const std::string& name) {
  if (toml.size() > kMaxBytes) throw Error(fmt::format("{}: expected at most {} bytes", name, kMaxBytes));
  const TomlReader reader(name);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"name", "skip_frames", "bones"});
  MotionConvention out;
  out.name = name_in(reader, reader.need(root, "name"), "name");
  out.skip_frames = int(reader.integer(reader.need(root, "skip_frames"), "skip_frames", 0, 1000));
  const toml::table& bones = reader.table(reader.need(root, "bones"), "bones");
  for (const auto& [key, node] : bones) {
    out.bones[bone_of(reader, node, key.str())] = read_source(reader, node, key.str());
  }
  for (std::size_t b = 0; b < kBoneCount; ++b) check_bone(reader, bones, out, b);
  return out;
}

const std::vector<MotionConvention>& builtin_conventions() {
  static const std::vector<MotionConvention> conventions = [] {
    std::vector<MotionConvention> out;
    for (const Builtin& builtin : kBuiltin) out.push_back(parse_convention(builtin.toml, builtin.name));
    return out;
  }();
  return conventions;
}

const MotionConvention& find_convention(const Motion& motion, const std::vector<MotionConvention>& conventions) {
  std::string tried;
  for (const MotionConvention& convention : conventions) {
    const std::string missing = missing_joint(motion, convention);
    if (missing.empty()) return convention;
    tried += fmt::format("{}{} (no joint {})", tried.empty() ? "" : ", ", convention.name, in_quotes(missing));
  }
  throw Error(fmt::format("{}: its joints fit none of the conventions known: {}", motion.name, tried));
}

std::vector<Pose> retarget(const Motion& motion, const MotionConvention& convention) {
  check_fit(motion, convention);
  const Sources sources = find_sources(motion, convention);
  std::vector<Pose> poses;
  for (int f = convention.skip_frames; f < motion.frame_count(); ++f) {
    poses.push_back(pose_of(motion, sources, f));
    poses.back()[Bone::pelvis] = without_yaw(poses.back()[Bone::pelvis]);
  }
  return poses;
}

Movement retarget_movement(const Motion& motion, const MotionConvention& convention) {
  constexpr float kTurn = 2.F * std::numbers::pi_v<float>;
  check_fit(motion, convention);
  const Sources sources = find_sources(motion, convention);
  const float leg = leg_length(motion, sources);
  Movement movement;
  movement.name = motion.name;
  movement.fps = motion.fps;
  for (int f = convention.skip_frames; f < motion.frame_count(); ++f) {
    BodyState state;
    state.pose = pose_of(motion, sources, f);
    state.heading_rad = take_heading(state.pose[Bone::pelvis]);
    if (!movement.states.empty()) {
      const float before = movement.states.back().heading_rad;
      state.heading_rad = before + std::remainder(state.heading_rad - before, kTurn);
    }
    state.root = Eigen::Vector2f(motion.root[f].x(), motion.root[f].z()) / leg;
    state.height = motion.root[f].y() / leg;
    movement.states.push_back(std::move(state));
  }
  if (movement.states.empty()) throw Error(motion.name + ": no frame of a person in it");
  return movement;
}

}  // namespace vesalius::synth
