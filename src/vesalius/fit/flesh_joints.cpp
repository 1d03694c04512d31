#include "vesalius/fit/flesh_joints.h"

#include <algorithm>

#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

constexpr const char* kFleshJoints =
#include "flesh_joints.inc"
    ;

FleshJoint read_joint(const TomlReader& reader, const toml::table& table, const std::string& set,
                      const FleshModel& flesh) {
  reader.expect_keys(table, {"name", "bone", "along", "offset"});
  FleshJoint joint;
  joint.set = set;
  joint.name = reader.string(reader.need(table, "name"), "name");
  const std::string bone = reader.string(reader.need(table, "bone"), "bone");
  joint.bone = flesh.find_bone(bone);
  if (joint.bone < 0) reader.fail(table, "bone " + in_quotes(bone) + ": expected a bone of the flesh");
  joint.along = reader.number(table, "along", -10.0, 10.0);
  if (!table.contains("offset")) return joint;
  const toml::array& offset = reader.array(table, "offset");
  if (offset.size() != 3) reader.fail(offset, "offset: expected 3 numbers");
  for (int i = 0; i < 3; ++i) joint.offset_m[i] = reader.number(*offset.get(i), "offset", -2.0, 2.0);
  return joint;
}

FleshJoint mirrored(FleshJoint joint, const FleshModel& flesh) {
  joint.name.front() = 'r';
  joint.bone = flesh.bones[joint.bone].mirror;
  joint.offset_m.x() = -joint.offset_m.x();
  return joint;
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
      joints.push_back(read_joint(reader, reader.table(joint, "joint"), set, flesh));
      if (joints.back().name.starts_with("l_")) joints.push_back(mirrored(joints.back(), flesh));
    }
  }
  return joints;
}

const std::vector<FleshJoint>& builtin_flesh_joints() {
  static const std::vector<FleshJoint> joints = parse_flesh_joints(kFleshJoints, "flesh_joints", builtin_flesh());
  return joints;
}

void place_joints(const FittedBody& fitted, const std::vector<FleshJoint>& places, const BodyModel& body,
                  std::vector<std::vector<Joint>>& joints) {
  for (std::size_t s = 0; s < body.joint_sets.size(); ++s) {
    const JointSet& set = body.joint_sets[s];
    for (std::size_t j = 0; j < set.joints.size(); ++j) {
      const auto place = std::ranges::find_if(
          places, [&](const FleshJoint& p) { return p.set == set.name && p.name == set.joints[j].name; });
      if (place == places.end()) continue;
      const FittedBone& bone = fitted.bones[place->bone];
      const float along = std::clamp(place->along, 0.F, 1.F);
      Joint& joint = joints[s][j];
      joint.state = bone.state;
      joint.position = bone.head + place->along * (bone.tail - bone.head) + bone.global * place->offset_m;
      joint.confidence = (1.F - along) * bone.confidence + along * bone.tail_confidence;
    }
  }
}

}  // namespace vesalius
