#include "synth/mocap/motion_convention.h"

#define TOML_EXCEPTIONS 1
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>

#include "synth/text/text_scanner.h"
#include "vesalius/base/error.h"

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

class ConventionReader {
 public:
  explicit ConventionReader(const std::string& name) : name_(name) {}

  MotionConvention read(const toml::table& root) const {
    expect_keys(root, {"name", "skip_frames", "bones"});
    MotionConvention out;
    out.name = string(need(root, "name"), "name");
    const toml::node& skip = need(root, "skip_frames");
    const auto frames = skip.value_exact<std::int64_t>();
    if (!frames || *frames < 0 || *frames > 1000) fail(skip, "skip_frames: expected a whole number from 0 to 1000");
    out.skip_frames = static_cast<int>(*frames);
    const toml::node& bones = need(root, "bones");
    if (!bones.is_table()) fail(bones, "bones: expected a table");
    for (const auto& [key, node] : *bones.as_table()) {
      out.bones[bone(node, key.str())] = source(node);
    }
    for (std::size_t b = 0; b < kBoneCount; ++b) check_bone(out, bones, b);
    return out;
  }

 private:
  [[noreturn]] void fail(const toml::node& at, const std::string& what) const {
    throw Error(fmt::format("{}:{}: {}", name_, at.source().begin.line, what));
  }
  void expect_keys(const toml::table& table, std::initializer_list<std::string_view> known) const {
    for (const auto& [key, node] : table) {
      if (std::ranges::find(known, key.str()) != known.end()) continue;
      std::string list;
      for (const std::string_view k : known) list.append(list.empty() ? "" : ", ").append(k);
      fail(node, fmt::format("unknown key {}, expected {}", in_quotes(key.str()), list));
    }
  }
  const toml::node& need(const toml::table& table, std::string_view key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(table, fmt::format("missing key \"{}\"", key));
    return *node;
  }
  std::string string(const toml::node& node, std::string_view what) const {
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty()) fail(node, fmt::format("{}: expected a string", what));
    return *value;
  }
  int bone(const toml::node& node, std::string_view bone_name) const {
    const int found = find_bone(bone_name);
    if (found < 0) fail(node, fmt::format("no bone is called {}", in_quotes(bone_name)));
    return found;
  }
  BoneSource source(const toml::node& node) const {
    if (!node.is_table()) fail(node, "expected { from = [...], rest = \"...\" }");
    const toml::table& table = *node.as_table();
    expect_keys(table, {"from", "rest"});
    BoneSource out;
    const toml::node& from = need(table, "from");
    if (!from.is_array() || from.as_array()->empty() || from.as_array()->size() > 2) {
      fail(from, "from: expected an array of one or two joints");
    }
    for (const toml::node& joint : *from.as_array()) out.from.push_back(string(joint, "from"));
    const std::string rest = string(need(table, "rest"), "rest");
    if (rest == "aim") {
      out.rest = RestRule::aim;
    } else if (rest != "same") {
      out.rest = RestRule::like;
      out.like = static_cast<Bone>(bone(need(table, "rest"), rest));
    }
    return out;
  }
  void check_bone(const MotionConvention& convention, const toml::node& bones, std::size_t b) const {
    const BoneSource& source = convention.bones[b];
    const std::string_view name = bone_name(static_cast<Bone>(b));
    if (source.from.empty()) fail(bones, fmt::format("missing bone \"{}\"", name));
    if (source.rest == RestRule::aim && source.from.size() > 1) {
      fail(bones, fmt::format("{}: rest \"aim\" needs a single joint", name));
    }
    if (source.rest == RestRule::like && convention.bones[index(source.like)].rest == RestRule::like) {
      fail(bones,
           fmt::format("{}: rest names {}, expected a bone with \"same\" or \"aim\"", name, bone_name(source.like)));
    }
  }

  const std::string& name_;
};

}  // namespace

MotionConvention parse_convention(std::string_view toml, const std::string& name) {
  if (toml.size() > kMaxBytes) throw Error(fmt::format("{}: expected at most {} bytes", name, kMaxBytes));
  toml::table root;
  try {
    root = toml::parse(toml);
  } catch (const toml::parse_error& e) {
    throw Error(fmt::format("{}:{}: not valid TOML: {}", name, e.source().begin.line, in_quotes(e.description())));
  }
  return ConventionReader(name).read(root);
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
