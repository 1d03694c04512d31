#include "synth/scene/gltf_model.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "synth/text/parse_json.h"
#include "synth/text/text_scanner.h"

namespace vesalius::synth {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "glTF's buffers are little-endian");

constexpr std::size_t kMostPrimitives = 100'000;
constexpr double kMostNumber = 1e6;

/// The type codes of glTF 2.0.
enum ComponentType : int { kUint8 = 5121, kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };
enum PrimitiveMode : int { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

std::uint32_t uint32_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The JSON and the binary chunk of a model.
struct Chunks {
  std::string json;
  std::string binary;
};

Chunks split(const ModelFiles& files, std::string bytes) {
  constexpr std::uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  if (!bytes.starts_with("glTF")) return {std::move(bytes), {}};
  if (bytes.size() < kHeader + kChunkHeader || uint32_at(bytes, 0) != kMagic) {
    files.fail(fmt::format("{} bytes that are no binary glTF", bytes.size()));
  }
  if (uint32_at(bytes, 4) != 2) files.fail(fmt::format("glTF {}, expected 2", uint32_at(bytes, 4)));
  Chunks chunks;
  for (std::size_t at = kHeader; at + kChunkHeader <= bytes.size();) {
    const std::size_t size = uint32_at(bytes, at);
    const std::uint32_t type = uint32_at(bytes, at + 4);
    at += kChunkHeader;
    if (size > bytes.size() - at) {
      files.fail(fmt::format("a chunk of {} bytes at byte {}, expected at most the {} that are left", size,
                             at - kChunkHeader, bytes.size() - at));
    }
    if (type == kJson && chunks.json.empty()) chunks.json = bytes.substr(at, size);
    if (type == kBinary && chunks.binary.empty()) chunks.binary = bytes.substr(at, size);
    at += size;
  }
  return chunks;
}

/// Decodes base64. Returns nothing if the text is not base64.
std::optional<std::string> from_base64(std::string_view text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  while (text.ends_with('=')) text.remove_suffix(1);
  for (const char c : text) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> unsigned(count) & 0xFFU));
  }
  return bytes;
}

class GltfReader {
 public:
  GltfReader(ModelFiles& files, ModelMesh& mesh) : files_(files), mesh_(mesh) {}

  void read() {
    Chunks chunks = split(files_, files_.model());
    binary_ = std::move(chunks.binary);
    root_ = parse_json(chunks.json, files_.path());
    if (!root_.is_object()) files_.fail("expected a JSON object");
    const std::string version = text(object(root_, "asset", "the file"), "version", "asset");
    if (!version.starts_with("2.")) files_.fail(fmt::format("glTF {}, expected 2", in_quotes(version)));
    refuse_extensions();
    visited_.assign(count("nodes"), false);
    const json& scene = item("scenes", whole(root_, "scene", "the file", 0));
    for (const json& node : list(scene, "nodes")) walk(node_index(node), Eigen::Affine3f::Identity());
  }

 private:
  /// Throws for required extensions, except for those that affect only the appearance.
  void refuse_extensions() const {
    for (const json& name : list(root_, "extensionsRequired")) {
      const std::string extension = name.is_string() ? name.get<std::string>() : "";
      if (extension.starts_with("KHR_materials_") || extension.starts_with("KHR_texture_")) continue;
      files_.fail(fmt::format("needs the extension {}, which is not known", in_quotes(extension)));
    }
  }

  // The following functions read values of the JSON. They throw an Error that names the place.

  const json& list(const json& of, const char* key) const {
    static const json kNone = json::array();
    const auto found = of.find(key);
    if (found == of.end()) return kNone;
    if (!found->is_array()) files_.fail(fmt::format("{}: expected a list", key));
    return *found;
  }
  std::size_t count(const char* key) const { return list(root_, key).size(); }
  const json& item(const char* key, std::size_t index) const {
    const json& all = list(root_, key);
    if (index >= all.size()) files_.fail(fmt::format("{} {}, expected one of {}", key, index, all.size()));
    if (!all[index].is_object()) files_.fail(fmt::format("{} {}: expected an object", key, index));
    return all[index];
  }
  const json& object(const json& of, const char* key, const std::string& place) const {
    const auto found = of.find(key);
    if (found == of.end() || !found->is_object()) files_.fail(fmt::format("{}: expected an object \"{}\"", place, key));
    return *found;
  }
  std::string text(const json& of, const char* key, const std::string& place) const {
    const auto found = of.find(key);
    if (found == of.end() || !found->is_string()) files_.fail(fmt::format("{}: expected a text \"{}\"", place, key));
    return found->get<std::string>();
  }
  /// Returns a whole number. If the key is missing, returns `otherwise`; without that the key is required.
  std::size_t whole(const json& of, const char* key, const std::string& place,
                    std::optional<std::size_t> otherwise = std::nullopt) const {
    const auto found = of.find(key);
    if (found == of.end() && otherwise) return *otherwise;
    if (found == of.end() || !found->is_number_unsigned() ||
        found->get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
      files_.fail(fmt::format("{}: expected a whole number \"{}\" below 2^32", place, key));
    }
    return found->get<std::size_t>();
  }
  /// Reads a list of exactly that many numbers. If the key is missing, `out` is unchanged.
  template <std::size_t N>
  void numbers(const json& of, const char* key, const std::string& place, std::array<float, N>& out) const {
    const json& all = list(of, key);
    if (all.empty()) return;
    if (all.size() != N) files_.fail(fmt::format("{}: {} numbers of \"{}\", expected {}", place, all.size(), key, N));
    for (std::size_t i = 0; i < N; ++i) {
      if (!all[i].is_number() || !(std::abs(all[i].get<double>()) <= kMostNumber)) {
        files_.fail(fmt::format("{}: \"{}\": expected numbers up to {:g}", place, key, kMostNumber));
      }
      out[i] = all[i].get<float>();
    }
  }
  std::size_t node_index(const json& value) const {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= visited_.size()) {
      files_.fail(fmt::format("a node {}, expected a number below {}", in_quotes(value.dump()), visited_.size()));
    }
    return value.get<std::size_t>();
  }

  Eigen::Affine3f transform_of(const json& node, const std::string& place) const {
    if (node.contains("matrix")) {
      std::array<float, 16> m{};
      numbers(node, "matrix", place, m);
      return Eigen::Affine3f(Eigen::Map<const Eigen::Matrix4f>(m.data()));  // column by column, as in Eigen
    }
    std::array<float, 3> move{}, scale{1.F, 1.F, 1.F};
    std::array<float, 4> turn{0.F, 0.F, 0.F, 1.F};
    numbers(node, "translation", place, move);
    numbers(node, "rotation", place, turn);
    numbers(node, "scale", place, scale);
    return Eigen::Translation3f(move[0], move[1], move[2]) *
           Eigen::Quaternionf(turn[3], turn[0], turn[1], turn[2]).normalized() *
           Eigen::Scaling(scale[0], scale[1], scale[2]);
  }

  /// Adds a node of a scene with its descendants. It refuses a node with two parents, since such a graph could expand
  /// without end.
  void walk(std::size_t first, const Eigen::Affine3f& scene_from_parent) {
    std::vector<std::pair<std::size_t, Eigen::Affine3f>> open{{first, scene_from_parent}};
    while (!open.empty()) {
      const auto [index, scene_from_above] = open.back();
      open.pop_back();
      const std::string place = fmt::format("nodes {}", index);
      if (visited_[index]) files_.fail(place + " is reached twice, expected a tree");
      visited_[index] = true;
      const json& node = item("nodes", index);
      const Eigen::Affine3f scene_from_node = scene_from_above * transform_of(node, place);
      if (node.contains("mesh")) add_mesh(whole(node, "mesh", place), scene_from_node);
      const json& children = list(node, "children");
      for (auto child = children.rbegin(); child != children.rend(); ++child) {
        open.emplace_back(node_index(*child), scene_from_node);
      }
    }
  }

  void add_mesh(std::size_t index, const Eigen::Affine3f& scene_from_mesh) {
    for (const json& primitive : list(item("meshes", index), "primitives")) {
      const std::string place = fmt::format("meshes {}", index);
      if (++primitives_ > kMostPrimitives) files_.fail(fmt::format("more than {} primitives", kMostPrimitives));
      if (!primitive.is_object()) files_.fail(place + ": expected objects as primitives");
      const int mode = static_cast<int>(whole(primitive, "mode", place, kTriangles));
      if (mode < kTriangles) continue;  // points and lines are skipped
      if (mode > kTriangleFan) files_.fail(fmt::format("{}: mode {}, expected 0 to 6", place, mode));
      const std::size_t positions = whole(object(primitive, "attributes", place), "POSITION", place);
      const auto base = static_cast<std::uint32_t>(mesh_.vertices().size());
      add_points(positions, scene_from_mesh);
      const auto points = static_cast<std::uint32_t>(mesh_.vertices().size()) - base;
      const std::uint8_t material = material_of(primitive, place);
      if (!primitive.contains("indices")) {
        add_triangles(
            mode, points, [&](std::size_t i) { return base + static_cast<std::uint32_t>(i); }, material);
        continue;
      }
      const std::size_t accessor = whole(primitive, "indices", place);
      const View view = view_of(accessor, "SCALAR");
      add_triangles(
          mode, view.count, [&](std::size_t i) { return base + index_at(view, i, points, accessor); }, material);
    }
  }

  template <class Corner>
  void add_triangles(int mode, std::size_t corners, const Corner& corner, std::uint8_t material) {
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners; i += step) {
      const bool odd = mode == kTriangleStrip && i % 2 == 1;
      const std::size_t first = mode == kTriangleFan ? 0 : i;
      mesh_.add_triangle({corner(first), corner(odd ? i + 2 : i + 1), corner(odd ? i + 1 : i + 2)}, material);
    }
  }

  /// The elements of an accessor. All of them lie within its buffer.
  struct View {
    const char* data = nullptr;
    std::size_t count = 0;
    std::size_t stride = 0;
    int component = 0;
  };

  View view_of(std::size_t index, std::string_view type) {
    const json& accessor = item("accessors", index);
    const std::string place = fmt::format("accessors {}", index);
    if (accessor.contains("sparse") || !accessor.contains("bufferView")) {
      files_.fail(place + ": sparse or compressed, expected plain values in a buffer");
    }
    if (text(accessor, "type", place) != type) files_.fail(fmt::format("{}: expected type {}", place, type));
    View view;
    view.component = static_cast<int>(whole(accessor, "componentType", place));
    view.count = whole(accessor, "count", place);
    const std::size_t size = element_size(view.component, type, place);
    const json& buffer_view = item("bufferViews", whole(accessor, "bufferView", place));
    const std::string& bytes = buffer(whole(buffer_view, "buffer", place));
    view.stride = whole(buffer_view, "byteStride", place, size);
    const std::size_t begin = whole(buffer_view, "byteOffset", place, 0) + whole(accessor, "byteOffset", place, 0);
    const std::size_t end = view.count == 0 ? begin : begin + (view.count - 1) * view.stride + size;
    if (view.stride < size || end > bytes.size()) {
      files_.fail(fmt::format("{}: {} elements from byte {}, expected them to end within the {} bytes of the buffer",
                              place, view.count, begin, bytes.size()));
    }
    view.data = bytes.data() + begin;
    return view;
  }

  std::size_t element_size(int component, std::string_view type, const std::string& place) const {
    if (type == "VEC3" && component == kFloat) return 12;
    if (type == "SCALAR" && component == kUint8) return 1;
    if (type == "SCALAR" && component == kUint16) return 2;
    if (type == "SCALAR" && component == kUint32) return 4;
    files_.fail(fmt::format("{}: component type {}, expected {}", place, component,
                            type == "VEC3" ? "5126 (float)" : "5121, 5123 or 5125 (unsigned)"));
  }

  void add_points(std::size_t accessor, const Eigen::Affine3f& scene_from_mesh) {
    const View view = view_of(accessor, "VEC3");
    mesh_.expect_room(view.count);
    for (std::size_t i = 0; i < view.count; ++i) {
      Eigen::Vector3f p;
      std::memcpy(p.data(), view.data + i * view.stride, 3 * sizeof(float));
      mesh_.add_vertex(scene_from_mesh * p);
    }
  }

  std::uint32_t index_at(const View& view, std::size_t i, std::uint32_t points, std::size_t accessor) const {
    std::uint32_t value = 0;
    std::memcpy(&value, view.data + i * view.stride, view.component == kUint8 ? 1 : view.component == kUint16 ? 2 : 4);
    if (value >= points) {
      files_.fail(fmt::format("accessors {}: index {} at {}, expected one below {}", accessor, value, i, points));
    }
    return value;
  }

  /// Returns a buffer, which is read when it is first used.
  const std::string& buffer(std::size_t index) {
    const auto [at, is_new] = buffers_.try_emplace(index);
    if (!is_new) return at->second;
    const std::string place = fmt::format("buffers {}", index);
    const json& entry = item("buffers", index);
    const std::size_t bytes = whole(entry, "byteLength", place);
    if (!entry.contains("uri") && index > 0) files_.fail(place + ": expected a \"uri\"");
    at->second = entry.contains("uri") ? fetched(text(entry, "uri", place), place) : std::move(binary_);
    if (at->second.size() < bytes) {
      files_.fail(fmt::format("{}: {} bytes, expected {}", place, at->second.size(), bytes));
    }
    return at->second;
  }

  std::string fetched(const std::string& uri, const std::string& place) {
    if (!uri.starts_with("data:")) {
      std::optional<std::string> bytes = files_.beside(uri);
      if (!bytes) files_.fail(fmt::format("{}: no file {} in the model's folder", place, in_quotes(uri)));
      return std::move(*bytes);
    }
    const std::size_t begin = uri.find(";base64,");
    std::optional<std::string> bytes;
    if (begin != std::string::npos) bytes = from_base64(std::string_view(uri).substr(begin + 8));
    if (!bytes) files_.fail(place + ": expected data in base64");
    return std::move(*bytes);
  }

  std::uint8_t material_of(const json& primitive, const std::string& place) {
    const std::size_t none = count("materials");
    const std::size_t index = whole(primitive, "material", place, none);
    const auto [at, is_new] = materials_.try_emplace(index);
    if (is_new) at->second = mesh_.add_material(index == none ? kPlainGrey : base_colour(index));
    return at->second;
  }
  Rgb base_colour(std::size_t index) const {
    const json& material = item("materials", index);
    std::array<float, 4> colour{1.F, 1.F, 1.F, 1.F};
    const auto found = material.find("pbrMetallicRoughness");
    if (found != material.end() && found->is_object()) {
      numbers(*found, "baseColorFactor", fmt::format("materials {}", index), colour);
    }
    return colour_of({colour[0], colour[1], colour[2]});
  }

  ModelFiles& files_;
  ModelMesh& mesh_;
  json root_;
  std::string binary_;  ///< binary chunk of a .glb
  std::vector<bool> visited_;
  std::size_t primitives_ = 0;
  std::map<std::size_t, std::string> buffers_;
  std::map<std::size_t, std::uint8_t> materials_;
};

}  // namespace

void read_gltf_model(ModelFiles& files, ModelMesh& mesh) { GltfReader(files, mesh).read(); }

}  // namespace vesalius::synth
