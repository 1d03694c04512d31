#include "evaluation/evaluation_joints.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/files/data_file.h"

namespace vesalius {
namespace {

constexpr const char* kEvaluationJoints =
#include "evaluation_joints.inc"
    ;

bool has_set(const BodyModel& body, const std::string& name) {
  return std::ranges::find(body.joint_sets, name, &JointSet::name) != body.joint_sets.end();
}

}  // namespace

BodyModel with_evaluation_joints(const BodyModel& body) {
  if (has_set(body, "kinect20") || has_set(body, "part_centres")) return body;
  for (const BodyPart& part : paper_body().parts) {
    if (body.find_part(part.name) < 0) return body;
  }
  return parse_body_model(body.toml + "\n" + kEvaluationJoints, "joints for evaluation");
}

BodyModel with_joints_of(const BodyModel& body, const std::string& file) {
  const auto lines = std::ranges::count(body.toml, '\n') + 1;
  return parse_body_model(body.toml + "\n" + read_file(file),
                          fmt::format("{}, after the {} lines of the model's body", file, lines));
}

}  // namespace vesalius
