#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "synth/mocap/motion.h"
#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr std::array<std::string_view, 7> kDofs = {"tx", "ty", "tz", "rx", "ry", "rz", "l"};
constexpr std::array<std::string_view, 10> kBoneKeys = {"id",  "name",   "direction", "length",  "axis",
                                                        "dof", "limits", "bodymass",  "cofmass", "end"};

class AsfParser {
 public:
  AsfParser(std::string_view text, const std::string& name) : scan_(text, name) {
    skeleton_.name = name;
    skeleton_.bones.emplace_back().name = "root";
  }

  AsfSkeleton parse();

 private:
  void section(std::string_view name);
  void skip_section();
  void units();
  void root();
  void bones();
  void bone();
  void bone_value(std::string_view key, AsfBone& bone);
  void hierarchy();
  void link(int parent, std::string_view child);
  int find(std::string_view name) const;
  void sort_parents_first();
  int dof(std::string_view word) const;
  std::array<int, 3> turn_order();
  Eigen::Vector3d triple(std::string_view what);
  Eigen::Quaterniond turned(const Eigen::Vector3d& angles, const std::array<int, 3>& order) const;

  TextScanner scan_;
  AsfSkeleton skeleton_;
  std::vector<std::vector<int>> children_;
  bool has_root_ = false, has_bones_ = false, has_hierarchy_ = false;
};

AsfSkeleton AsfParser::parse() {
  while (!scan_.at_end()) {
    const std::string_view word = scan_.word("a section");
    if (word[0] == '#') {
      scan_.skip_line();
    } else if (word[0] == ':') {
      section(word);
    } else {
      scan_.fail(fmt::format("expected a section such as :bonedata, found {}", in_quotes(word)));
    }
  }
  if (!has_root_) scan_.fail("expected a section :root before the end");
  if (!has_bones_) scan_.fail("expected a section :bonedata before the end");
  if (!has_hierarchy_) scan_.fail("expected a section :hierarchy before the end");
  sort_parents_first();
  return std::move(skeleton_);
}

void AsfParser::section(std::string_view name) {
  if (name == ":units") {
    units();
  } else if (name == ":root") {
    root();
  } else if (name == ":bonedata") {
    bones();
  } else if (name == ":hierarchy") {
    hierarchy();
  } else {
    skip_section();
  }
}

void AsfParser::skip_section() {
  scan_.skip_line();
  while (!scan_.at_end() && scan_.peek()[0] != ':') scan_.skip_line();
}

void AsfParser::units() {
  while (!scan_.at_end() && scan_.peek()[0] != ':') {
    const std::string_view key = scan_.word("a unit");
    const std::string_view value = scan_.word("the value of a unit");
    if (key != "angle") continue;
    if (!value.starts_with("deg") && !value.starts_with("rad")) {
      scan_.fail(fmt::format("angle: expected deg or rad, found {}", in_quotes(value)));
    }
    skeleton_.degrees = value.starts_with("deg");
  }
}

void AsfParser::root() {
  AsfBone& bone = skeleton_.bones[0];
  Eigen::Vector3d orientation = Eigen::Vector3d::Zero();
  while (!scan_.at_end() && scan_.peek()[0] != ':') {
    const std::string_view key = scan_.word("a property of the root");
    if (key == "order") {
      bone.dofs.clear();
      while (!scan_.at_line_end()) bone.dofs.push_back(dof(scan_.word("a dof")));
    } else if (key == "axis") {
      bone.turn_order = turn_order();
    } else if (key == "position") {
      triple("the root's position");  // not used, since every frame has its own position
    } else if (key == "orientation") {
      orientation = triple("the root's orientation");
    } else {
      scan_.fail(fmt::format("expected order, axis, position or orientation, found {}", in_quotes(key)));
    }
  }
  bone.axis = turned(orientation, bone.turn_order);
  has_root_ = true;
}

void AsfParser::bones() {
  if (has_bones_) scan_.fail("a second section :bonedata");
  has_bones_ = true;
  while (!scan_.at_end() && scan_.peek()[0] != ':') {
    scan_.expect("begin");
    bone();
  }
}

void AsfParser::bone() {
  AsfBone read;
  for (std::string_view key = scan_.word("a property of a bone"); key != "end";
       key = scan_.word("a property of a bone or end")) {
    bone_value(key, read);
  }
  if (read.name.empty()) scan_.fail("a bone without a name");
  if (find(read.name) >= 0) scan_.fail(fmt::format("a second bone called {}", in_quotes(read.name)));
  if (skeleton_.bones.size() == kMaxMotionJoints) scan_.fail(fmt::format("more than {} bones", kMaxMotionJoints));
  skeleton_.bones.push_back(std::move(read));
}

void AsfParser::bone_value(std::string_view key, AsfBone& bone) {
  if (key == "name") {
    bone.name = scan_.word("the bone's name");
  } else if (key == "direction") {
    const Eigen::Vector3d read = triple("the bone's direction");
    if (read.norm() < 1e-6) scan_.fail("direction: expected a vector other than 0");
    bone.direction = read.normalized().cast<float>();
  } else if (key == "length") {
    bone.length = float(scan_.number("the bone's length"));
  } else if (key == "axis") {
    const Eigen::Vector3d angles = triple("the bone's axis");
    bone.turn_order = turn_order();
    bone.axis = turned(angles, bone.turn_order);
  } else if (key == "dof") {
    bone.dofs.clear();
    while (!scan_.at_line_end()) bone.dofs.push_back(dof(scan_.word("a dof")));
  } else if (std::ranges::find(kBoneKeys, key) != kBoneKeys.end()) {
    while (!scan_.at_end() && std::ranges::find(kBoneKeys, scan_.peek()) == kBoneKeys.end()) scan_.word(key);
  } else {
    scan_.fail(fmt::format("expected a property of a bone such as axis, found {}", in_quotes(key)));
  }
}

int AsfParser::dof(std::string_view word) const {
  const auto* found = std::ranges::find_if(kDofs, [&](auto known) { return same_word(word, known); });
  if (found == kDofs.end()) scan_.fail(fmt::format("expected tx, ty, tz, rx, ry, rz or l, found {}", in_quotes(word)));
  return int(found - kDofs.begin());
}

std::array<int, 3> AsfParser::turn_order() {
  const std::string_view word = scan_.word("the order of axes");
  std::array<int, 3> order{};
  for (std::size_t i = 0; i < 3 && word.size() == 3; ++i) order[i] = (word[i] | 0x20) - 'x';
  std::array<int, 3> sorted = order;
  std::ranges::sort(sorted);
  if (word.size() != 3 || sorted != std::array<int, 3>{0, 1, 2}) {
    scan_.fail(fmt::format("expected an order of axes such as XYZ, found {}", in_quotes(word)));
  }
  return order;
}

Eigen::Vector3d AsfParser::triple(std::string_view what) {
  Eigen::Vector3d read;
  for (double& value : read) value = scan_.number(what);
  return read;
}

Eigen::Quaterniond AsfParser::turned(const Eigen::Vector3d& angles, const std::array<int, 3>& order) const {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (const int axis : order) q = axis_rotation(axis, angles[axis] * (skeleton_.degrees ? kDegree : 1.0)) * q;
  return q;
}

int AsfParser::find(std::string_view name) const {
  const auto found = std::ranges::find(skeleton_.bones, name, &AsfBone::name);
  return found == skeleton_.bones.end() ? -1 : int(found - skeleton_.bones.begin());
}

void AsfParser::hierarchy() {
  if (!has_bones_) scan_.fail(":hierarchy: expected :bonedata before it");
  children_.resize(skeleton_.bones.size());
  has_hierarchy_ = true;
  scan_.expect("begin");
  while (scan_.peek() != "end") {
    const std::string_view word = scan_.word("a bone or end");
    const int parent = find(word);
    if (parent < 0) scan_.fail(fmt::format("no bone is called {}", in_quotes(word)));
    while (!scan_.at_line_end()) link(parent, scan_.word("a bone"));
  }
  scan_.expect("end");
}

void AsfParser::link(int parent, std::string_view child) {
  const int found = find(child);
  if (found < 0) scan_.fail(fmt::format("no bone is called {}", in_quotes(child)));
  AsfBone& bone = skeleton_.bones[found];
  if (found == 0 || bone.parent >= 0) scan_.fail(fmt::format("bone {} hangs from two others", in_quotes(child)));
  bone.parent = parent;
  children_[parent].push_back(found);
}

void AsfParser::sort_parents_first() {
  std::vector<AsfBone> sorted;
  std::vector<int> new_index(skeleton_.bones.size(), -1);
  for (std::vector<int> open = {0}; !open.empty();) {
    const auto i = static_cast<std::size_t>(open.back());
    open.pop_back();
    new_index[i] = int(sorted.size());
    AsfBone& bone = skeleton_.bones[i];
    if (bone.parent >= 0) bone.parent = new_index[bone.parent];
    sorted.push_back(bone);
    open.insert(open.end(), children_[i].rbegin(), children_[i].rend());
  }
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] < 0)
      scan_.fail(fmt::format("bone {} does not hang from the root", in_quotes(skeleton_.bones[i].name)));
  }
  skeleton_.bones = std::move(sorted);
}

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

AsfSkeleton parse_asf(std::string_view text, const std::string& name) { return AsfParser(text, name).parse(); }

Motion parse_amc(std::string_view text, const std::string& name, const AsfSkeleton& skeleton, float fps) {
  if (skeleton.bones.empty()) throw Error(fmt::format("{}: its skeleton has no bones", name));
  if (!(fps > 0.F && fps <= 1e5F)) throw Error(fmt::format("{}: expected more than 0 frames per second", name));
  Motion motion = AmcParser(text, name, skeleton).parse();
  motion.fps = fps;
  return motion;
}

}  // namespace vesalius::synth
