#include "vesalius/fit/flesh_joints.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

constexpr const char* kFleshJoints =
#include "flesh_joints.inc"
    ;

/// Returns the rotation that turns a direction into another, at most a right angle away. Eigen's FromTwoVectors turns
/// into opposite ones too, by a decomposition that takes the compiler ten seconds.
Eigen::Quaternionf turn_between(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  const Eigen::Vector3f a = from.normalized(), b = to.normalized();
  const float twice_w = std::sqrt((1.F + b.dot(a)) * 2.F);
  const Eigen::Vector3f axis = a.cross(b) * (1.F / twice_w);
  return {twice_w * 0.5F, axis.x(), axis.y(), axis.z()};
}

FleshJoint mirrored_joint(FleshJoint joint, const FleshModel& flesh) {
  joint.name.front() = 'r';
  joint.bone = flesh.bones[joint.bone].mirror;
  joint.offset_m.x() = -joint.offset_m.x();
  // The mirror image of a right-handed frame with all axes reversed is the frame turned by half a turn about x.
  if (joint.axes) joint.axes = Eigen::Quaternionf(0.F, 1.F, 0.F, 0.F) * *joint.axes;
  return joint;
}

/// Returns the axis that "+x" to "-z" names, or zero.
Eigen::Vector3f named_axis(const std::string& name) {
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();
  if (name.size() != 2 || (name[0] != '+' && name[0] != '-') || name[1] < 'x' || name[1] > 'z') return axis;
  axis[name[1] - 'x'] = name[0] == '+' ? 1.F : -1.F;
  return axis;
}

Eigen::Quaternionf read_axes(const TomlReader& reader, const toml::table& table, const char* key) {
  const toml::array& names = reader.array(table, key);
  Eigen::Matrix3f axes = Eigen::Matrix3f::Zero();
  for (std::size_t i = 0; i < names.size() && i < 3; ++i) {
    axes.col(static_cast<Eigen::Index>(i)) = named_axis(reader.string(*names.get(i), key));
  }
  if (names.size() != 3 || axes.determinant() != 1.F) {
    reader.fail(names, std::string(key) + R"(: expected three axes of a right-handed frame, such as "+x", "+z", "-y")");
  }
  return Eigen::Quaternionf(axes);
}

/// Reads a joint, and its mirror image if it has one.
std::vector<FleshJoint> read_joint(const TomlReader& reader, const toml::table& table, const std::string& set,
                                   const FleshModel& flesh) {
  reader.expect_keys(table, {"name", "bone", "along", "offset", "axes", "right_axes", "x_on_bone"});
  FleshJoint joint;
  joint.set = set;
  joint.name = reader.string(reader.need(table, "name"), "name");
  const std::string bone = reader.string(reader.need(table, "bone"), "bone");
  joint.bone = flesh.find_bone(bone);
  if (joint.bone < 0) reader.fail(table, "bone " + in_quotes(bone) + ": expected a bone of the flesh");
  joint.along = reader.number(table, "along", -10.0, 10.0);
  if (table.contains("offset")) {
    const toml::array& offset = reader.array(table, "offset");
    if (offset.size() != 3) reader.fail(offset, "offset: expected 3 numbers");
    for (int i = 0; i < 3; ++i) joint.offset_m[i] = reader.number(*offset.get(i), "offset", -2.0, 2.0);
  }
  if (table.contains("axes")) joint.axes = read_axes(reader, table, "axes");
  joint.x_on_bone = table.contains("x_on_bone") && reader.boolean(table, "x_on_bone");
  if (!joint.name.starts_with("l_")) return {joint};
  FleshJoint right = mirrored_joint(joint, flesh);
  if (table.contains("right_axes")) right.axes = read_axes(reader, table, "right_axes");
  return {joint, right};
}

}  // namespace

std::vector<FleshJoint> parse_flesh_joints(std::string_view toml, const std::string& source, const FleshModel& flesh) {
  const TomlReader reader(source);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"joint_set"});
  std::vector<FleshJoint> joints;
  for (const toml::node& node : reader.array(root, "joint_set")) {
    const toml::table& table = reader.table(node, "joint_set");
    reader.expect_keys(table, {"name", "joint"});
    const std::string set = reader.string(reader.need(table, "name"), "name");
    for (const toml::node& joint : reader.array(table, "joint")) {
      std::ranges::move(read_joint(reader, reader.table(joint, "joint"), set, flesh), std::back_inserter(joints));
    }
  }
  return joints;
}

const std::vector<FleshJoint>& builtin_flesh_joints() {
  static const std::vector<FleshJoint> joints = parse_flesh_joints(kFleshJoints, "flesh_joints", builtin_flesh());
  return joints;
}

const FleshJoint* find_flesh_joint(const std::vector<FleshJoint>& places, std::string_view set, std::string_view name) {
  const auto place = std::ranges::find_if(places, [&](const FleshJoint& p) { return p.set == set && p.name == name; });
  return place == places.end() ? nullptr : &*place;
}

TrustSignals signals_of(const FleshJoint& joint, const FittedBody& fitted) {
  const FittedBone& bone = fitted.bones[joint.bone];
  return between(bone.of_head, bone.of_tail, std::clamp(joint.along, 0.F, 1.F));
}

void place_joints(const FittedBody& fitted, const std::vector<FleshJoint>& places, const BodyModel& body,
                  const BodyTrust& trust, std::vector<std::vector<Joint>>& joints) {
  for (std::size_t s = 0; s < body.joint_sets.size(); ++s) {
    const JointSet& set = body.joint_sets[s];
    for (std::size_t j = 0; j < set.joints.size(); ++j) {
      const FleshJoint* place = find_flesh_joint(places, set.name, set.joints[j].name);
      if (place == nullptr) continue;
      const FittedBone& bone = fitted.bones[place->bone];
      Joint& joint = joints[s][j];
      joint.state = bone.state;
      joint.position = bone.head + place->along * (bone.tail - bone.head) + bone.global * place->offset_m;
      joint.confidence = trusted(trust, source_of(fitted, bone), signals_of(*place, fitted));
    }
  }
}

std::vector<std::optional<Eigen::Quaternionf>> joint_rotations(const FittedBody& fitted,
                                                               const std::vector<FleshJoint>& places,
                                                               const JointSet& set) {
  std::vector<std::optional<Eigen::Quaternionf>> rotations(set.joints.size());
  for (std::size_t j = 0; j < set.joints.size(); ++j) {
    const FleshJoint* place = find_flesh_joint(places, set.name, set.joints[j].name);
    if (place == nullptr || !place->axes) continue;
    const FittedBone& bone = fitted.bones[place->bone];
    if (bone.state == State::none) continue;
    Eigen::Quaternionf rotation = bone.global * *place->axes;
    if (place->x_on_bone) {
      const Eigen::Vector3f x = rotation * Eigen::Vector3f::UnitX(), line = bone.tail - bone.head;
      rotation = turn_between(x, x.dot(line) < 0.F ? -line : line) * rotation;
    }
    rotations[j] = rotation.normalized();
  }
  return rotations;
}

std::vector<std::optional<Eigen::Quaternionf>> rotations_of(const TrackedPerson& person, const JointSet& set) {
  if (!person.body) return std::vector<std::optional<Eigen::Quaternionf>>(set.joints.size());
  return joint_rotations(*person.body, builtin_flesh_joints(), set);
}

}  // namespace vesalius
