#include "synth/body/makehuman_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::size_t kMostVertices = 1'000'000;
constexpr double kFarthest = 1000.0;  // decimetres; keeps the arithmetic finite

/// Returns the vertex of a face's corner, "12" or "12/3" or "12/3/4", counted from 0.
std::uint32_t corner(const TextScanner& scan, std::string_view word, std::size_t vertex_count) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value < 1 || value > vertex_count) {
    scan.fail(fmt::format("expected a vertex number from 1 to {}, found {}", vertex_count, in_quotes(word)));
  }
  return value - 1;
}

/// Reads three coordinates. If `more` is true, others may follow them on the line.
Eigen::Vector3f point(TextScanner& scan, bool more) {
  Eigen::Vector3f p;
  for (float& x : p) {
    if (scan.at_line_end()) scan.fail("expected three coordinates, found the end of the line");
    const double value = scan.number("a coordinate");
    if (!(std::abs(value) < kFarthest)) scan.fail(fmt::format("expected a coordinate below {} in size", kFarthest));
    x = float(value);
  }
  if (!more && !scan.at_line_end()) scan.fail("expected the end of the line after three coordinates");
  return p;
}

void add_face(TextScanner& scan, ObjGroup& mesh) {
  std::vector<std::uint32_t> corners;
  while (!scan.at_line_end()) corners.push_back(corner(scan, scan.word("a vertex"), mesh.vertices.size()));
  if (corners.size() < 3) scan.fail(fmt::format("face of {} corners, expected at least 3", corners.size()));
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

/// Returns whether every edge is used once in each direction.
bool closed(const std::vector<Triangle>& triangles) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
  std::ranges::sort(edges);
  if (std::ranges::adjacent_find(edges) != edges.end()) return false;
  return std::ranges::all_of(edges, [&](const auto& e) {
    return std::ranges::binary_search(edges, std::pair{e.second, e.first});
  });
}

using nlohmann::json;

constexpr std::size_t kMostBones = 1000;

/// Parses untrusted JSON: at most 4 million values, nested at most 100 deep.
json parse_json(std::string_view text, const std::string& name) {
  constexpr std::size_t kMostValues = 4'000'000;
  constexpr int kDeepest = 100;
  std::size_t values = 0;
  const auto within_limits = [&](int depth, json::parse_event_t /*event*/, json& /*value*/) {
    if (depth > kDeepest) throw Error(fmt::format("{}: JSON nested deeper than {} levels", name, kDeepest));
    if (++values > kMostValues) throw Error(fmt::format("{}: more than {} JSON values", name, kMostValues));
    return true;
  };
  try {
    return json::parse(text, within_limits);
  } catch (const json::parse_error& e) {
    const auto line = 1 + std::ranges::count(text.substr(0, std::min(e.byte, text.size())), '\n');
    throw Error(fmt::format("{}:{}: not valid JSON", name, line));
  } catch (const json::out_of_range&) {
    throw Error(fmt::format("{}: not valid JSON: a number beyond all bounds", name));
  }
}

[[noreturn]] void fail(const std::string& file, const std::string& what) {
  throw Error(fmt::format("{}: {}", file, what));
}

const json& object(const json& in, const char* key, const std::string& file, const std::string& place) {
  const auto found = in.is_object() ? in.find(key) : in.end();
  if (found == in.end() || !found->is_object()) fail(file, fmt::format("{}: expected an object \"{}\"", place, key));
  return *found;
}

std::string text_of(const json& in, const char* key, const std::string& file, const std::string& place) {
  const auto found = in.is_object() ? in.find(key) : in.end();
  if (found == in.end() || !found->is_string()) fail(file, fmt::format("{}: expected a text \"{}\"", place, key));
  return found->get<std::string>();
}

/// Returns the vertices whose mean is a joint.
std::vector<std::uint32_t> joint(const json& joints, const std::string& key, std::size_t vertex_count,
                                 const std::string& file) {
  const auto found = joints.find(key);
  if (found == joints.end() || !found->is_array() || found->empty()) {
    fail(file, fmt::format("joint \"{}\": expected a list of vertices", shown(key)));
  }
  std::vector<std::uint32_t> vertices;
  for (const json& value : *found) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= vertex_count) {
      fail(file,
           fmt::format("joint \"{}\": vertex {}, expected 0 to {}", shown(key), shown(value.dump()), vertex_count - 1));
    }
    vertices.push_back(value.get<std::uint32_t>());
  }
  return vertices;
}

/// Returns the bones with every bone after its parent, and otherwise in the order of names.
std::vector<SkeletonBone> parents_first(const std::vector<SkeletonBone>& bones,
                                        const std::vector<std::string>& parent_names, const std::string& file) {
  std::vector<SkeletonBone> ordered;
  std::vector<bool> placed(bones.size(), false);
  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t b = 0; b < bones.size(); ++b) {
      const auto parent = std::ranges::find(ordered, parent_names[b], &SkeletonBone::name);
      if (placed[b] || (parent == ordered.end() && !parent_names[b].empty())) continue;
      const int parent_index = parent_names[b].empty() ? -1 : int(parent - ordered.begin());
      ordered.push_back(bones[b]);
      ordered.back().parent = parent_index;
      placed[b] = moved = true;
    }
  }
  const auto left = std::ranges::find(placed, false);
  if (left != placed.end()) {
    fail(file, fmt::format("bone \"{}\": its parents form a ring or one is missing",
                           shown(bones[left - placed.begin()].name)));
  }
  return ordered;
}

/// The weights of one vertex while they are being read.
struct Influence {
  std::uint16_t bone;
  float weight;
};

SkinWeights strongest(std::vector<Influence>& all) {
  std::ranges::stable_sort(all, std::ranges::greater(), &Influence::weight);
  if (all.size() > 4) all.resize(4);
  float sum = 0.F;
  for (const Influence& i : all) sum += i.weight;
  SkinWeights out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    out.bone[k] = all[k].bone;
    out.weight[k] = all[k].weight / sum;
  }
  return out;
}

void add_weights(const json& list, std::uint16_t bone, const std::string& place, const std::string& file,
                 std::vector<std::vector<Influence>>& vertices) {
  if (!list.is_array()) fail(file, fmt::format("{}: expected a list", place));
  for (const json& entry : list) {
    const bool pair = entry.is_array() && entry.size() == 2 && entry[0].is_number_unsigned() && entry[1].is_number();
    const std::uint64_t vertex = pair ? entry[0].get<std::uint64_t>() : 0;
    const float weight = pair ? entry[1].get<float>() : -1.F;
    if (!pair || vertex >= vertices.size() || !(weight >= 0.F && weight <= 1.F)) {
      fail(file, fmt::format("{}: {}, expected [vertex from 0 to {}, weight from 0 to 1]", place, shown(entry.dump()),
                             vertices.size() - 1));
    }
    if (weight > 0.F) vertices[vertex].push_back({bone, weight});
  }
}

}  // namespace

ObjGroup parse_obj(std::string_view text, const std::string& name, std::string_view group) {
  ObjGroup mesh;
  bool wanted = false;
  TextScanner scan(text, name);
  while (!scan.at_end()) {
    const std::string_view what = scan.word("a word");
    if (what == "v") {
      if (mesh.vertices.size() == kMostVertices) scan.fail(fmt::format("more than {} vertices", kMostVertices));
      mesh.vertices.push_back(point(scan, true));
    } else if (what == "g") {
      wanted = !scan.at_line_end() && scan.word("a group") == group;
    } else if (what == "f" && wanted) {
      add_face(scan, mesh);
    }
    while (!scan.at_line_end()) scan.word("a word");
  }
  if (mesh.triangles.empty()) throw Error(fmt::format("{}: no faces in group \"{}\", expected some", name, group));
  if (!closed(mesh.triangles)) {
    throw Error(fmt::format("{}: group \"{}\" is not a closed surface: is the file cut short?", name, group));
  }
  return mesh;
}

MorphTarget parse_target(std::string_view text, const std::string& name, std::size_t vertex_count) {
  MorphTarget target;
  TextScanner scan(text, name);
  while (!scan.at_end()) {
    if (scan.peek().front() == '#') {
      scan.skip_line();
      continue;
    }
    target.vertex.push_back(static_cast<std::uint32_t>(scan.whole("a vertex", 0, int(vertex_count) - 1)));
    target.offset.push_back(point(scan, false));
  }
  return target;
}

std::vector<SkeletonBone> parse_skeleton(std::string_view text, const std::string& name, std::size_t vertex_count) {
  const json root = parse_json(text, name);
  const json& joints = object(root, "joints", name, "top level");
  const json& list = object(root, "bones", name, "top level");
  if (list.empty() || list.size() > kMostBones) {
    fail(name, fmt::format("{} bones, expected 1 to {}", list.size(), kMostBones));
  }
  std::vector<SkeletonBone> bones;
  std::vector<std::string> parents;
  for (const auto& [bone_name, value] : list.items()) {
    const std::string place = fmt::format("bone \"{}\"", shown(bone_name));
    SkeletonBone bone;
    bone.name = bone_name;
    bone.head = joint(joints, text_of(value, "head", name, place), vertex_count, name);
    bone.tail = joint(joints, text_of(value, "tail", name, place), vertex_count, name);
    const bool root_bone = value.contains("parent") && value["parent"].is_null();
    parents.push_back(root_bone ? "" : text_of(value, "parent", name, place));
    bones.push_back(std::move(bone));
  }
  return parents_first(bones, parents, name);
}

std::vector<SkinWeights> parse_weights(std::string_view text, const std::string& name,
                                       const std::vector<SkeletonBone>& bones, std::size_t vertex_count,
                                       const std::vector<std::uint32_t>& skinned) {
  const json root = parse_json(text, name);
  std::vector<std::vector<Influence>> vertices(vertex_count);
  for (const auto& [bone_name, list] : object(root, "weights", name, "top level").items()) {
    const auto bone = std::ranges::find(bones, bone_name, &SkeletonBone::name);
    const std::string place = fmt::format("weights of bone \"{}\"", shown(bone_name));
    if (bone == bones.end()) fail(name, fmt::format("{}: the skeleton has no such bone", place));
    add_weights(list, static_cast<std::uint16_t>(bone - bones.begin()), place, name, vertices);
  }
  std::vector<SkinWeights> weights;
  for (const std::uint32_t v : skinned) {
    float sum = 0.F;
    for (const Influence& i : vertices[v]) sum += i.weight;
    if (!(std::abs(sum - 1.F) <= 0.1F)) {
      fail(name, fmt::format("vertex {}: its weights sum to {}, expected 1 within 0.1", v, sum));
    }
    weights.push_back(strongest(vertices[v]));
  }
  return weights;
}

}  // namespace vesalius::synth
