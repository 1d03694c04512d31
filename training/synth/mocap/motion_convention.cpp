#include "synth/mocap/motion_convention.h"

#include <fmt/format.h>

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
    reader.fail(bones, fmt::format("{}: rest names {}, expected a bone with \"same\" or \"aim\"", name,
                                   bone_name(source.like)));
  }
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

}  // namespace vesalius::synth
