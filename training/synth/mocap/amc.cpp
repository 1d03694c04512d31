#include "synth/mocap/amc.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr int kFirstTurn = 3;
constexpr int kLengthDof = 6;

class AmcParser {
 public:
  AmcParser(std::string_view text, const std::string& name, const AsfSkeleton& skeleton)
      : scan_(text, name), skeleton_(skeleton), degrees_(skeleton.degrees), values_(skeleton.bones.size()) {
    motion_.name = name;
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
      const AsfBone& bone = skeleton.bones[b];
      index_[bone.name] = b;
      Eigen::Vector3f offset = Eigen::Vector3f::Zero();  // a bone begins at the end of its parent
      if (bone.parent >= 0) {
        const AsfBone& parent = skeleton.bones[bone.parent];
        offset = parent.direction * parent.length;
      }
      motion_.joints.push_back({bone.name, bone.parent, offset, bone.direction});
    }
  }

  Motion parse();

 private:
  void flag(std::string_view word);
  void frame();
  void bone_line();
  void finish_frame();
  Eigen::Quaterniond local(std::size_t bone) const;

  /// The numbers of one bone in one frame, in the order of the dofs' numbers.
  struct Values {
    std::array<double, kLengthDof + 1> by_dof{};
    bool given = false;
  };

  TextScanner scan_;
  const AsfSkeleton& skeleton_;
  bool degrees_;
  std::vector<Values> values_;
  std::map<std::string, std::size_t, std::less<>> index_;
  Motion motion_;
};

Motion AmcParser::parse() {
  while (!scan_.at_end() && (scan_.peek()[0] == '#' || scan_.peek()[0] == ':')) {
    flag(scan_.word("a flag"));
    scan_.skip_line();
  }
  while (!scan_.at_end()) frame();
  if (motion_.root.empty()) scan_.fail("expected at least one frame");
  return std::move(motion_);
}

void AmcParser::flag(std::string_view word) {
  if (same_word(word, ":DEGREES")) degrees_ = true;
  if (same_word(word, ":RADIANS")) degrees_ = false;
}

void AmcParser::frame() {
  scan_.whole("the number of a frame", 0, 1'000'000'000);
  if (!scan_.at_line_end()) scan_.fail("expected the number of a frame alone on its line");
  if ((motion_.root.size() + 1) * motion_.joints.size() > kMaxMotionRotations) scan_.fail("too many frames");
  std::ranges::fill(values_, Values{});
  const auto names_bone = [&] {
    const std::string_view next = scan_.peek();
    return !next.empty() && (next[0] < '0' || next[0] > '9');
  };
  while (names_bone()) bone_line();
  finish_frame();
}

void AmcParser::bone_line() {
  const std::string_view name = scan_.word("a bone");
  const auto found = index_.find(name);
  if (found == index_.end()) {
    scan_.fail(fmt::format("bone {} is not in the skeleton {}", in_quotes(name), skeleton_.name));
  }
  Values& values = values_[found->second];
  if (values.given) scan_.fail(fmt::format("bone {} stands twice in a frame", in_quotes(name)));
  values.given = true;
  const std::vector<int>& dofs = skeleton_.bones[found->second].dofs;
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    if (scan_.at_line_end()) {
      scan_.fail(fmt::format("bone {}: expected {} numbers, found {}", in_quotes(name), dofs.size(), i));
    }
    values.by_dof[dofs[i]] = scan_.number("an angle or a position");
  }
  if (!scan_.at_line_end()) {
    scan_.fail(fmt::format("bone {}: expected {} numbers, found more", in_quotes(name), dofs.size()));
  }
}

Eigen::Quaterniond AmcParser::local(std::size_t b) const {
  const AsfBone& bone = skeleton_.bones[b];
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (const int axis : bone.turn_order) {
    const double angle = values_[b].by_dof[kFirstTurn + axis];
    turn = axis_rotation(axis, angle * (degrees_ ? kDegree : 1.0)) * turn;
  }
  return bone.axis * turn * bone.axis.conjugate();
}

void AmcParser::finish_frame() {
  const std::size_t first = motion_.world.size();
  for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
    const int parent = skeleton_.bones[b].parent;
    Eigen::Quaternionf world = local(b).cast<float>();
    if (parent >= 0) world = motion_.world[first + parent] * world;
    motion_.world.push_back(world.normalized());
  }
  const auto& root = values_[0].by_dof;
  motion_.root.emplace_back(float(root[0]), float(root[1]), float(root[2]));
}

}  // namespace

Motion parse_amc(std::string_view text, const std::string& name, const AsfSkeleton& skeleton, float fps) {
  if (skeleton.bones.empty()) throw Error(fmt::format("{}: its skeleton has no bones", name));
  if (!(fps > 0.F && fps <= 1e5F)) throw Error(fmt::format("{}: expected more than 0 frames per second", name));
  Motion motion = AmcParser(text, name, skeleton).parse();
  motion.fps = fps;
  return motion;
}

}  // namespace vesalius::synth
