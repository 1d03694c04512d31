#include "export/write_gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "export/flesh_mesh.h"

namespace vesalius {
namespace {

using GltfJson = nlohmann::ordered_json;

/// The binary part of a glTF file with its accessors.
class GltfBuffer {
 public:
  /// What a view is for, as glTF numbers it; nothing for keys of animations and matrices.
  enum class Target { none = 0, vertices = 34962, triangles = 34963 };

  /// Adds numbers, `of_each` to an element, and returns the accessor's index.
  template <class Number>
  std::size_t add(const std::vector<Number>& values, std::size_t of_each, Target target = Target::none) {
    const std::size_t size = values.size() * sizeof(Number);
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    GltfJson view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (target != Target::none) view["target"] = static_cast<int>(target);
    accessors_.push_back({{"bufferView", views_.size()},
                          {"componentType", component_type(Number{})},
                          {"count", values.size() / of_each},
                          {"type", type_of(of_each)}});
    views_.push_back(std::move(view));
    bytes_.append(reinterpret_cast<const char*>(values.data()), size);
    return accessors_.size() - 1;
  }

  /// As `add`, with the range, which keys of animations and places of vertices must say.
  std::size_t add_with_range(const std::vector<float>& values, std::size_t of_each, Target target = Target::none) {
    const std::size_t index = add(values, of_each, target);
    std::vector<float> low(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(of_each)), high = low;
    for (std::size_t i = of_each; i < values.size(); ++i) {
      low[i % of_each] = std::min(low[i % of_each], values[i]);
      high[i % of_each] = std::max(high[i % of_each], values[i]);
    }
    accessors_[index]["min"] = low;
    accessors_[index]["max"] = high;
    return index;
  }

  std::size_t add_points(const std::vector<Eigen::Vector3f>& points) {
    std::vector<float> values;
    for (const Eigen::Vector3f& point : points) values.insert(values.end(), point.begin(), point.end());
    return add_with_range(values, 3, Target::vertices);
  }

  /// Puts the lists of accessors and views into the file's JSON and returns the bytes.
  std::string finish(GltfJson& gltf) {
    gltf["accessors"] = std::move(accessors_);
    gltf["bufferViews"] = std::move(views_);
    gltf["buffers"] = GltfJson::array({{{"byteLength", bytes_.size()}}});
    return std::move(bytes_);
  }

 private:
  static int component_type(std::uint8_t /*unused*/) { return 5121; }
  static int component_type(std::uint16_t /*unused*/) { return 5123; }
  static int component_type(float /*unused*/) { return 5126; }
  static const char* type_of(std::size_t of_each) {
    return of_each == 1 ? "SCALAR" : of_each == 3 ? "VEC3" : of_each == 4 ? "VEC4" : "MAT4";
  }

  GltfJson accessors_ = GltfJson::array(), views_ = GltfJson::array();
  std::string bytes_;
};

/// Returns a person's colour, linear red, green, blue and opacity: those of the viewer, by Okabe and Ito, which the
/// colour-blind can tell.
GltfJson colour_of(int id) {
  constexpr std::array<std::array<int, 3>, 7> kColours{
      {{230, 159, 0}, {86, 180, 233}, {0, 158, 115}, {204, 121, 167}, {240, 228, 66}, {213, 94, 0}, {0, 114, 178}}};
  constexpr double kGamma = 2.2;  // of sRGB, nearly
  GltfJson colour = GltfJson::array();
  for (const int part : kColours[static_cast<std::size_t>(id) % kColours.size()]) {
    colour.push_back(std::round(1e4 * std::pow(part / 255.0, kGamma)) / 1e4);
  }
  colour.push_back(1.0);
  return colour;
}

template <class Vector>
GltfJson numbers_json(const Vector& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

/// A scene with people and one animation.
class GltfScene {
 public:
  explicit GltfScene(const std::vector<MovingSkeleton>& skeletons) : several_(skeletons.size() > 1) {
    for (const MovingSkeleton& skeleton : skeletons) {
      for (const MovingSkeleton::Pose& pose : skeleton.poses) times_s_.insert(pose.time_s);
    }
  }

  void add(const MovingSkeleton& skeleton) {
    const std::size_t root = nodes_.size();
    const std::vector<float> times = keys_of(skeleton);
    const std::size_t input = buffer_.add_with_range(times, 1);
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) add_bone(skeleton, b, root, input);
    roots_.push_back(root);
    if (skeleton.shape.empty()) return;
    add_flesh(skeleton, root, input);
    show_while_there(skeleton, times, root);
  }

  std::string finish() {
    GltfJson gltf{
        {"asset", {{"version", "2.0"}, {"generator", "vesalius " VESALIUS_VERSION}}},
        {"scene", 0},
        {"scenes", GltfJson::array({{{"nodes", std::move(roots_)}}})},
        {"nodes", std::move(nodes_)},
        {"animations",
         GltfJson::array(
             {{{"name", "people"}, {"channels", std::move(channels_)}, {"samplers", std::move(samplers_)}}})}};
    if (!meshes_.empty()) {
      gltf["meshes"] = std::move(meshes_);
      gltf["materials"] = std::move(materials_);
      gltf["skins"] = std::move(skins_);
    }
    std::string bytes = buffer_.finish(gltf);
    std::string chunks;
    append_chunk(chunks, "JSON", gltf.dump(), ' ');
    append_chunk(chunks, std::string("BIN\0", 4).c_str(), std::move(bytes), '\0');
    std::string out = "glTF";
    append_word(out, 2);
    append_word(out, static_cast<std::uint32_t>(12 + chunks.size()));
    return out + chunks;
  }

 private:
  using Pose = MovingSkeleton::Pose;

  static void append_word(std::string& out, std::uint32_t word) {
    for (unsigned i = 0; i < 4; ++i) out += static_cast<char>(word >> (8 * i) & 255U);
  }

  static void append_chunk(std::string& out, const char* type, std::string content, char filler) {
    content.resize((content.size() + 3) / 4 * 4, filler);
    append_word(out, static_cast<std::uint32_t>(content.size()));
    out.append(type, 4);
    out += content;
  }

  float key_at(double time_s) const { return float(time_s - *times_s_.begin()); }

  /// Returns the times of a person's frames as keys, which must rise strictly: recordings may have two frames at one
  /// time.
  std::vector<float> keys_of(const MovingSkeleton& skeleton) const {
    std::vector<float> keys;
    for (const Pose& pose : skeleton.poses) {
      const float key = key_at(pose.time_s);
      keys.push_back(keys.empty() || key > keys.back() ? key : std::nextafter(keys.back(), 1e9F));
    }
    return keys;
  }

  std::string name_of(const MovingSkeleton& skeleton, const std::string& name) const {
    return several_ ? fmt::format("person{}:{}", skeleton.id, name) : name;
  }

  void animate(std::size_t node, const char* path, std::size_t input, std::size_t output,
               const char* between = "LINEAR") {
    channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers_.push_back({{"input", input}, {"output", output}, {"interpolation", between}});
  }

  /// Adds a bone's node, which stands as in the first frame where nothing is animated.
  void add_bone(const MovingSkeleton& skeleton, std::size_t bone, std::size_t root, std::size_t input) {
    const auto place_in = [&](const Pose& pose) { return bone == 0 ? pose.root_m : pose.offsets_m[bone]; };
    const Pose& first = skeleton.poses.front();
    GltfJson node{{"name", name_of(skeleton, skeleton.bones[bone].name)},
                  {"translation", numbers_json(place_in(first))},
                  {"rotation", numbers_json(first.local[bone].coeffs())}};
    GltfJson children = GltfJson::array();
    for (std::size_t child = bone + 1; child < skeleton.bones.size(); ++child) {
      if (skeleton.bones[child].parent == int(bone)) children.push_back(root + child);
    }
    if (!children.empty()) node["children"] = std::move(children);
    nodes_.push_back(std::move(node));
    std::vector<float> turns, places;
    for (const Pose& pose : skeleton.poses) {
      for (const double part : pose.local[bone].coeffs()) turns.push_back(float(part));
      for (const double along : place_in(pose)) places.push_back(float(along));
    }
    animate(root + bone, "rotation", input, buffer_.add(turns, 4));
    animate(root + bone, "translation", input, buffer_.add(places, 3));
  }

  /// Adds a person's mesh, in a T with the hips at the origin, its skin, and how its shape changes.
  void add_flesh(const MovingSkeleton& skeleton, std::size_t root, std::size_t input) {
    std::vector<int> bones;
    std::vector<Eigen::Vector3f> heads;
    for (const MovingSkeleton::Bone& bone : skeleton.bones) {
      bones.push_back(bone.flesh);
      const Eigen::Vector3f offset = bone.offset_m.cast<float>();
      heads.emplace_back(bone.parent < 0 ? offset : heads[bone.parent] + offset);
    }
    const Eigen::VectorXf shape =
        Eigen::Map<const Eigen::VectorXf>(skeleton.shape.data(), static_cast<Eigen::Index>(skeleton.shape.size()));
    FleshMesh mesh = flesh_mesh(builtin_flesh(), bones, shape.cast<double>());
    for (std::size_t i = 0; i < mesh.points.size(); ++i) mesh.points[i] += heads[mesh.bones[i]];
    const std::vector<ShapeRange> ranges = span_shapes(skeleton, mesh);
    const std::size_t node = nodes_.size();
    const std::string name = name_of(skeleton, "Body");
    nodes_.push_back({{"name", name}, {"mesh", meshes_.size()}, {"skin", skins_.size()}});
    roots_.push_back(node);
    add_skin(heads, root);
    meshes_.push_back({{"name", name}, {"primitives", GltfJson::array({primitive_of(mesh)})}});
    materials_.push_back(
        {{"name", name},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", colour_of(skeleton.id)}, {"metallicFactor", 0}, {"roughnessFactor", 0.8}}}});
    if (ranges.empty()) return;
    GltfJson& usual = meshes_.back()["weights"] = GltfJson::array();
    for (const ShapeRange& range : ranges) usual.push_back(range.share(skeleton.shape));
    std::vector<float> weights;
    for (const Pose& pose : skeleton.poses) {
      for (const ShapeRange& range : ranges) weights.push_back(range.share(pose.shape));
    }
    animate(node, "weights", input, buffer_.add(weights, 1));
  }

  /// Which numbers one of a person's shapes has over the frames.
  struct ShapeRange {
    std::size_t shape = 0;
    float low = 0.F, high = 0.F;

    float share(const std::vector<float>& of) const { return (of[shape] - low) / (high - low); }
  };

  /// Makes the mesh that of the lowest numbers, and its shapes, of which those stay that change, what leads to the
  /// highest: programs show weights from 0 to 1 alone.
  static std::vector<ShapeRange> span_shapes(const MovingSkeleton& skeleton, FleshMesh& mesh) {
    std::vector<ShapeRange> ranges;
    for (std::size_t k = 0; k < mesh.shapes.size(); ++k) {
      ShapeRange range{k, skeleton.shape[k], skeleton.shape[k]};
      for (const Pose& pose : skeleton.poses) {
        range.low = std::min(range.low, pose.shape[k]);
        range.high = std::max(range.high, pose.shape[k]);
      }
      if (range.high == range.low) continue;
      std::vector<Eigen::Vector3f>& span = mesh.shapes[ranges.size()] = mesh.shapes[k];
      for (std::size_t i = 0; i < span.size(); ++i) {
        mesh.points[i] += (range.low - skeleton.shape[k]) * span[i];
        span[i] *= range.high - range.low;
      }
      ranges.push_back(range);
    }
    mesh.shapes.resize(ranges.size());
    return ranges;
  }

  void add_skin(const std::vector<Eigen::Vector3f>& heads, std::size_t root) {
    std::vector<float> inverses;
    GltfJson joints = GltfJson::array();
    for (const Eigen::Vector3f& head : heads) {
      Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
      inverse.topRightCorner<3, 1>() = -head;
      inverses.insert(inverses.end(), inverse.data(), inverse.data() + inverse.size());
      joints.push_back(root + joints.size());
    }
    skins_.push_back(
        {{"inverseBindMatrices", buffer_.add(inverses, 16)}, {"skeleton", root}, {"joints", std::move(joints)}});
  }

  /// Each vertex goes with one bone alone.
  GltfJson primitive_of(const FleshMesh& mesh) {
    std::vector<std::uint8_t> joints;
    std::vector<float> weights;
    for (const std::uint8_t bone : mesh.bones) {
      joints.insert(joints.end(), {bone, 0, 0, 0});
      weights.insert(weights.end(), {1.F, 0.F, 0.F, 0.F});
    }
    GltfJson targets = GltfJson::array();
    for (const std::vector<Eigen::Vector3f>& shape : mesh.shapes) {
      targets.push_back({{"POSITION", buffer_.add_points(shape)}});
    }
    const auto vertices = GltfBuffer::Target::vertices;
    GltfJson primitive{{"attributes",
                        {{"POSITION", buffer_.add_points(mesh.points)},
                         {"NORMAL", buffer_.add_points(mesh.normals)},
                         {"JOINTS_0", buffer_.add(joints, 4, vertices)},
                         {"WEIGHTS_0", buffer_.add(weights, 4, vertices)}}},
                       {"indices", buffer_.add(mesh.triangles, 1, GltfBuffer::Target::triangles)},
                       {"material", materials_.size()}};
    if (!targets.empty()) primitive["targets"] = std::move(targets);
    return primitive;
  }

  /// Hides who is not there yet, away or gone, as glTF wants it: by a scale of nothing.
  void show_while_there(const MovingSkeleton& skeleton, const std::vector<float>& times, std::size_t root) {
    std::vector<float> keys, scales;
    std::optional<bool> shown;
    const auto show = [&](float key, bool there) {
      if (there == shown) return;
      shown = there;
      keys.push_back(key);
      scales.insert(scales.end(), 3, there ? 1.F : 0.F);
    };
    if (times.front() > 0.F) show(0.F, false);
    for (std::size_t i = 0; i < times.size(); ++i) show(times[i], skeleton.poses[i].there);
    const auto next = times_s_.upper_bound(skeleton.poses.back().time_s);
    if (next != times_s_.end() && key_at(*next) > times.back()) show(key_at(*next), false);
    if (keys.size() > 1) animate(root, "scale", buffer_.add_with_range(keys, 1), buffer_.add(scales, 3), "STEP");
  }

  bool several_;
  std::set<double> times_s_;  ///< of all people
  GltfBuffer buffer_;
  GltfJson nodes_ = GltfJson::array(), roots_ = GltfJson::array(), meshes_ = GltfJson::array(),
           materials_ = GltfJson::array(), skins_ = GltfJson::array(), samplers_ = GltfJson::array(),
           channels_ = GltfJson::array();
};

}  // namespace

std::string to_glb(const std::vector<MovingSkeleton>& skeletons) {
  GltfScene scene(skeletons);
  for (const MovingSkeleton& skeleton : skeletons) scene.add(skeleton);
  return scene.finish();
}

}  // namespace vesalius
