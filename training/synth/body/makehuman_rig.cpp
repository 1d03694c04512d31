#include "synth/body/makehuman_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "synth/text/parse_json.h"
#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using nlohmann::json;

constexpr std::size_t kMostBones = 1000;

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
