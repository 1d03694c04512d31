#include "vesalius/body_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

constexpr std::size_t kMaxParts = 200;
constexpr std::size_t kMaxSurfaceRules = 4000;
constexpr std::size_t kMaxName = 64;

constexpr std::string_view kPaperBody =
#include "paper_body.inc"
    ;

class Reader : public TomlReader {
 public:
  using TomlReader::TomlReader;

  /// Reads a name. It must be safe in JSON, pictures and file names.
  std::string name(const toml::table& table, std::string_view key) const {
    const toml::node& node = need(table, key);
    std::string value = string(node, key);
    const auto allowed = [](unsigned char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    };
    if (value.empty() || value.size() > kMaxName || !std::ranges::all_of(value, allowed)) {
      fail(node, std::string(key) + " " + in_quotes(value) + ": expected 1 to 64 letters, digits, '_' or '-'");
    }
    return value;
  }

  /// Returns the index of the part that `node` names.
  int part(const BodyModel& body, const toml::node& node, std::string_view what) const {
    const std::string value = string(node, what);
    const int index = body.find_part(value);
    if (index < 0) fail(node, std::string(what) + ": no part is called " + in_quotes(value));
    return index;
  }
};

// Limits in metres and square metres on a part of a person, even a giant. They keep later arithmetic finite.
constexpr double kSmallest = 1e-3;
constexpr double kLargest = 100.0;

Rgb read_colour(const Reader& reader, const toml::table& table) {
  const toml::array& values = reader.array(table, "colour");
  if (values.size() != 3) reader.fail(values, "colour: expected 3 whole numbers, red, green and blue, from 0 to 255");
  const auto value = [&](std::size_t i) {
    return static_cast<std::uint8_t>(reader.integer(values[i], "colour", 0, 255));
  };
  return {value(0), value(1), value(2)};
}

void read_parts(const Reader& reader, const toml::table& root, BodyModel& body) {
  const toml::array& array = reader.array(root, "part");
  if (array.empty() || array.size() > kMaxParts) {
    reader.fail(array,
                "part: expected 1 to " + std::to_string(kMaxParts) + " parts, found " + std::to_string(array.size()));
  }
  for (const toml::node& node : array) {
    const toml::table& table = reader.table(node, "part");
    reader.expect_keys(table, {"name", "colour", "mirror", "max_extent", "area", "upper_body"});
    BodyPart part;
    part.name = reader.name(table, "name");
    if (body.find_part(part.name) >= 0) reader.fail(table, "part: the name " + in_quotes(part.name) + " is used twice");
    part.colour = read_colour(reader, table);
    part.max_extent_m = reader.number(table, "max_extent", kSmallest, kLargest);
    part.typical_area_m2 = reader.number(table, "area", 1e-6, kLargest);
    part.upper_body = reader.boolean(table, "upper_body");
    body.parts.push_back(std::move(part));
  }
  for (std::size_t i = 0; i < array.size(); ++i) {  // a partner may come after the part that names it
    body.parts[i].mirror = reader.part(body, reader.need(*array.get(i)->as_table(), "mirror"), "mirror");
  }
  for (std::size_t i = 0; i < array.size(); ++i) {
    const BodyPart& partner = body.parts[body.parts[i].mirror];
    if (partner.mirror != int(i)) {
      reader.fail(*array.get(i), "part " + in_quotes(body.parts[i].name) + ": its mirror " + in_quotes(partner.name) +
                                     " does not name it in return");
    }
  }
}

/// Throws if links form a ring. A part that does not reach the top within as many steps as there are parts is in a
/// ring.
void check_no_ring(const Reader& reader, const toml::array& array, const BodyModel& body,
                   const std::vector<int>& parent) {
  for (std::size_t link = 0; link < body.links.size(); ++link) {
    int at = body.links[link].child;
    for (int steps = 0; at >= 0; ++steps, at = parent[at]) {
      if (steps > body.part_count()) {
        const std::string& name = body.parts[body.links[link].child].name;
        reader.fail(*array.get(link), "link: " + in_quotes(name) + " hangs in a ring, expected a tree");
      }
    }
  }
}

void read_links(const Reader& reader, const toml::table& root, BodyModel& body) {
  static const toml::array kNone;
  const toml::array& array = root.contains("link") ? reader.array(root, "link") : kNone;
  std::vector<int> parent(body.parts.size(), -1);
  for (const toml::node& node : array) {
    const toml::table& table = reader.table(node, "link");
    reader.expect_keys(table, {"parent", "child", "length", "tolerance"});
    BodyLink link;
    link.parent = reader.part(body, reader.need(table, "parent"), "parent");
    link.child = reader.part(body, reader.need(table, "child"), "child");
    link.length_m = reader.number(table, "length", kSmallest, kLargest);
    link.tolerance_m = reader.number(table, "tolerance", kSmallest, kLargest);
    int& known = parent[link.child];
    const std::string& child = body.parts[link.child].name;
    if (link.child == link.parent) reader.fail(table, "link: " + in_quotes(child) + " cannot be its own parent");
    if (known >= 0) reader.fail(table, "link: " + in_quotes(child) + " has a second parent, expected a tree");
    known = link.parent;
    body.links.push_back(link);
  }
  check_no_ring(reader, array, body, parent);
  if (body.links.size() + 1 != body.parts.size()) {
    // If there are no rings and no second parents, each missing link leaves one more part without a parent.
    reader.fail(array.empty() ? static_cast<const toml::node&>(root) : array,
                "link: expected " + std::to_string(body.parts.size() - 1) + " links, one tree over all parts, found " +
                    std::to_string(body.links.size()));
  }
}

void read_roots(const Reader& reader, const toml::table& root, BodyModel& body) {
  const toml::array& array = reader.array(root, "roots");
  if (array.empty()) reader.fail(array, "roots: expected at least one part");
  for (const toml::node& node : array) {
    const int index = reader.part(body, node, "roots");
    if (std::ranges::find(body.roots, index) != body.roots.end()) {
      reader.fail(node, "roots: " + in_quotes(body.parts[index].name) + " is listed twice");
    }
    body.roots.push_back(index);
  }
}

JointDefinition read_joint(const Reader& reader, const toml::node& node, const BodyModel& body) {
  const toml::table& table = reader.table(node, "joint");
  reader.expect_keys(table, {"name", "parts", "weights", "depth_offset", "up_offset"});
  JointDefinition joint;
  joint.name = reader.name(table, "name");
  for (const toml::node& part : reader.array(table, "parts")) {
    joint.parts.push_back(reader.part(body, part, "parts"));
  }
  if (joint.parts.empty()) return joint;
  const toml::array& weights = reader.array(table, "weights");
  if (weights.size() != joint.parts.size()) {
    reader.fail(weights, "weights: expected as many as parts, " + std::to_string(joint.parts.size()) + ", found " +
                             std::to_string(weights.size()));
  }
  double sum = 0.0;
  for (const toml::node& weight : weights) {
    joint.weights.push_back(reader.number(weight, "weights", -10.0, 10.0));
    sum += double(joint.weights.back());
  }
  if (std::abs(sum - 1.0) > 1e-3) reader.fail(weights, "weights: expected a sum of 1, found " + std::to_string(sum));
  joint.depth_offset_m = reader.number(table, "depth_offset", -1.0, 1.0);
  if (table.contains("up_offset")) joint.up_offset_m = reader.number(table, "up_offset", -1.0, 1.0);
  return joint;
}

void read_joint_sets(const Reader& reader, const toml::table& root, BodyModel& body) {
  if (!root.contains("joint_set")) return;
  std::set<std::string> set_names;
  for (const toml::node& node : reader.array(root, "joint_set")) {
    const toml::table& table = reader.table(node, "joint_set");
    reader.expect_keys(table, {"name", "joint"});
    JointSet set;
    set.name = reader.name(table, "name");
    if (!set_names.insert(set.name).second) reader.fail(table, "joint_set: " + in_quotes(set.name) + " is used twice");
    std::set<std::string> joint_names;
    for (const toml::node& joint : reader.array(table, "joint")) {
      set.joints.push_back(read_joint(reader, joint, body));
      const std::string& name = set.joints.back().name;
      if (!joint_names.insert(name).second) {
        reader.fail(joint, "joint_set " + in_quotes(set.name) + ": the joint " + in_quotes(name) + " is used twice");
      }
    }
    body.joint_sets.push_back(std::move(set));
  }
}

constexpr int kMaxFactors = 64;

/// Reads an array of as many numbers, each at most 10 m from 0.
std::vector<float> read_lengths(const Reader& reader, const toml::table& table, std::string_view key, int count) {
  const toml::array& values = reader.array(table, key);
  if (int(values.size()) != count) {
    reader.fail(values, std::string(key) + ": expected " + std::to_string(count) + " numbers, found " +
                            std::to_string(values.size()));
  }
  std::vector<float> read;
  for (const toml::node& value : values) read.push_back(reader.number(value, key, -10.0, 10.0));
  return read;
}

void read_distribution(const Reader& reader, const toml::table& root, BodyModel& body) {
  if (!root.contains("distribution")) return;
  const toml::table& table = reader.table(reader.need(root, "distribution"), "distribution");
  reader.expect_keys(table, {"factors", "noise", "confidence", "voted_confidence", "part"});
  PartDistribution& distribution = body.distribution;
  distribution.factors = int(reader.integer(reader.need(table, "factors"), "factors", 0, kMaxFactors));
  distribution.noise_m = reader.number(table, "noise", 1e-3, 1.0);
  const auto read_confidence = [&](const char* key) {
    const std::vector<float> read = read_lengths(reader, table, key, 2);
    return PartDistribution::Confidence{read[0], read[1]};
  };
  distribution.confidence = read_confidence("confidence");
  if (table.contains("voted_confidence")) distribution.voted_confidence = read_confidence("voted_confidence");
  const toml::array& parts = reader.array(table, "part");
  if (parts.size() != body.parts.size()) {
    reader.fail(parts, "part: expected the " + std::to_string(body.parts.size()) + " parts of the body, found " +
                           std::to_string(parts.size()));
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const toml::table& entry = reader.table(*parts.get(p), "part");
    reader.expect_keys(entry, {"name", "mean", "residual", "depth", "observed", "x", "y", "z"});
    if (reader.name(entry, "name") != body.parts[p].name) {
      reader.fail(entry, "name: expected " + in_quotes(body.parts[p].name) + ", parts in the body's order");
    }
    PartDistribution::Part& part = distribution.parts.emplace_back();
    std::ranges::copy(read_lengths(reader, entry, "mean", 3), part.mean_m.begin());
    part.residual_m = reader.number(entry, "residual", 0.0, 10.0);
    if (entry.contains("depth")) part.depth_m = reader.number(entry, "depth", -1.0, 1.0);
    if (entry.contains("observed")) part.observed_m = reader.number(entry, "observed", 0.0, 10.0);
    constexpr std::array kAxes{"x", "y", "z"};
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      part.factors_m[axis] = read_lengths(reader, entry, kAxes[axis], distribution.factors);
    }
  }
}

SurfaceRule::Side read_side(const Reader& reader, const toml::table& table) {
  const toml::node* node = table.get("side");
  if (node == nullptr) return SurfaceRule::Side::both;
  const std::string side = reader.string(*node, "side");
  if (side == "both") return SurfaceRule::Side::both;
  if (side == "left") return SurfaceRule::Side::left;
  if (side == "right") return SurfaceRule::Side::right;
  reader.fail(*node, "side " + in_quotes(side) + R"(: expected "both", "left" or "right")");
}

void read_surface(const Reader& reader, const toml::table& root, BodyModel& body) {
  if (!root.contains("surface")) return;
  const toml::array& array = reader.array(root, "surface");
  if (array.size() > kMaxSurfaceRules) {
    reader.fail(array, "surface: expected at most " + std::to_string(kMaxSurfaceRules) + " rules, found " +
                           std::to_string(array.size()));
  }
  for (const toml::node& node : array) {
    const toml::table& table = reader.table(node, "surface");
    reader.expect_keys(table, {"part", "bone", "from", "to", "side"});
    SurfaceRule rule;
    rule.part = reader.part(body, reader.need(table, "part"), "part");
    rule.bone = reader.name(table, "bone");
    rule.from = reader.number(table, "from", 0.0, 1.0);
    rule.to = reader.number(table, "to", 0.0, 1.0);
    if (rule.to <= rule.from) reader.fail(table, R"(surface: expected "to" to be larger than "from")");
    rule.side = read_side(reader, table);
    rule.line = int(table.source().begin.line);
    body.surface.push_back(std::move(rule));
  }
}

}  // namespace

int BodyModel::find_part(std::string_view part_name) const {
  const auto found = std::ranges::find(parts, part_name, &BodyPart::name);
  return found == parts.end() ? -1 : int(found - parts.begin());
}

BodyModel parse_body_model(std::string_view toml, const std::string& source) {
  const Reader reader(source);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"name", "roots", "part", "link", "joint_set", "distribution", "surface"});
  BodyModel body;
  body.name = reader.name(root, "name");
  read_parts(reader, root, body);
  read_links(reader, root, body);
  read_roots(reader, root, body);
  read_joint_sets(reader, root, body);
  read_distribution(reader, root, body);
  read_surface(reader, root, body);
  body.toml = toml;
  return body;
}

std::vector<int> part_slots(const BodyModel& body) {
  std::vector<int> slots;
  int next = 0;
  for (int p = 0; p < body.part_count(); ++p) {
    const int mirror = body.parts[p].mirror;
    slots.push_back(mirror >= 0 && mirror < p ? slots[mirror] : next++);
  }
  return slots;
}

int kind_count(const std::vector<int>& slots) { return *std::ranges::max_element(slots) + 1; }

const BodyModel& paper_body() {
  static const BodyModel body = parse_body_model(kPaperBody, "paper25");
  return body;
}

std::size_t find_joint_set(const BodyModel& body, std::string_view name) {
  const auto found = std::ranges::find(body.joint_sets, name, &JointSet::name);
  if (found != body.joint_sets.end()) return static_cast<std::size_t>(found - body.joint_sets.begin());
  std::string known;
  for (const JointSet& set : body.joint_sets) known += (known.empty() ? "" : ", ") + set.name;
  throw UsageError("joint set " + in_quotes(name) + " is not of this body, expected one of: " + known);
}

}  // namespace vesalius
