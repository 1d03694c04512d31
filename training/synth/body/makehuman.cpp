#include "synth/body/makehuman.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "synth/body/makehuman_files.h"
#include "synth/body/rig_map.h"
#include "synth/body/surface_parts.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kMetresPerUnit = 0.1F;  // MakeHuman's files are in decimetres
constexpr std::size_t kMostTargets = 5000;

/// Numbers the vertices that are used: first those of the surface, then those of joints.
class Selection {
 public:
  explicit Selection(std::size_t vertex_count) : new_index_(vertex_count, kNone) {}

  std::uint32_t add(std::uint32_t vertex) {
    std::uint32_t& index = new_index_[vertex];
    if (index == kNone) {
      index = static_cast<std::uint32_t>(chosen_.size());
      chosen_.push_back(vertex);
    }
    return index;
  }
  bool find(std::uint32_t vertex, std::uint32_t& index) const {
    index = new_index_[vertex];
    return index != kNone;
  }
  const std::vector<std::uint32_t>& chosen() const { return chosen_; }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> new_index_;
  std::vector<std::uint32_t> chosen_;
};

struct Target {
  std::vector<std::uint8_t> factors;
  MorphTarget morph;

  float weight(const FactorValues& values) const {
    float product = 1.F;
    for (const std::uint8_t f : factors) product *= values[f];
    return product;
  }
};

/// Returns the target's offsets of chosen vertices under their new numbers.
MorphTarget chosen_of(const MorphTarget& all, const Selection& selection) {
  MorphTarget out;
  for (std::size_t k = 0; k < all.vertex.size(); ++k) {
    std::uint32_t index = 0;
    if (!selection.find(all.vertex[k], index)) continue;
    out.vertex.push_back(index);
    out.offset.push_back(all.offset[k]);
  }
  return out;
}

Eigen::Vector3f mean(const std::vector<Eigen::Vector3f>& points, const std::vector<std::uint32_t>& of) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const std::uint32_t v : of) sum += points[v];
  return sum / float(of.size());
}

struct File {
  std::string_view path, text;
};

// Not constexpr: texts of half a megabyte take more steps than clang counts up to.
const File kFiles[] = {
#include "builtin_body.inc"
};

}  // namespace

struct MakeHumanModel::State {
  std::vector<Eigen::Vector3f> base;  ///< first vertices of the surface, then those of joints; decimetres
  std::size_t surface_count = 0;
  std::vector<Triangle> triangles;
  std::vector<SkinWeights> skin;
  std::vector<SkeletonBone> skeleton;
  MappedRig rig;
  std::vector<Target> targets;

  std::vector<Eigen::Vector3f> morphed(const MakeHumanFactors& factors) const {
    const FactorValues values = factor_values(factors);
    std::vector<Eigen::Vector3f> points = base;
    for (const Target& target : targets) {
      const float weight = target.weight(values);
      if (weight < 1e-4F) continue;
      for (std::size_t k = 0; k < target.morph.vertex.size(); ++k) {
        points[target.morph.vertex[k]] += weight * target.morph.offset[k];
      }
    }
    return points;
  }
};

MakeHumanModel::Files MakeHumanModel::files(const std::string& data_folder, std::vector<std::string> targets) {
  return {data_folder + "/3dobjs/base.obj", data_folder + "/rigs/default.mhskel",
          data_folder + "/rigs/default_weights.mhw", std::move(targets)};
}

MakeHumanModel::MakeHumanModel(const ReadText& read, const Files& files) {
  auto state = std::make_unique<State>();
  ObjGroup mesh = parse_obj(read(files.mesh), files.mesh, "body");
  const std::size_t count = mesh.vertices.size();
  Selection selection(count);
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = selection.add(v);
  }
  state->surface_count = selection.chosen().size();
  state->skeleton = parse_skeleton(read(files.skeleton), files.skeleton, count);
  const std::vector<SkinWeights> skin =
      parse_weights(read(files.weights), files.weights, state->skeleton, count, selection.chosen());
  state->skin = skin;
  for (SkeletonBone& bone : state->skeleton) {
    for (std::uint32_t& v : bone.head) v = selection.add(v);
    for (std::uint32_t& v : bone.tail) v = selection.add(v);
  }
  for (const std::uint32_t v : selection.chosen()) state->base.push_back(mesh.vertices[v]);
  state->triangles = std::move(mesh.triangles);
  state->rig = map_rig(state->skeleton, makehuman_rig_map());
  if (files.targets.empty() || files.targets.size() > kMostTargets) {
    throw Error(fmt::format("MakeHuman: {} targets, expected 1 to {}", files.targets.size(), kMostTargets));
  }
  for (const std::string& path : files.targets) {
    state->targets.push_back({factors_of_name(path), chosen_of(parse_target(read(path), path, count), selection)});
  }
  state_ = std::move(state);
}

MakeHumanModel::~MakeHumanModel() = default;

BodyMesh make_body(const MakeHumanModel& model, const MakeHumanFactors& factors, const BodyModel& body) {
  const MakeHumanModel::State& state = *model.state_;
  std::vector<Eigen::Vector3f> points = state.morphed(factors);
  float lowest = std::numeric_limits<float>::max();
  float highest = std::numeric_limits<float>::lowest();
  for (std::size_t v = 0; v < state.surface_count; ++v) {
    lowest = std::min(lowest, points[v].y());
    highest = std::max(highest, points[v].y());
  }
  BodyMesh mesh;
  mesh.stature_m = factors.stature_m > 0.F ? factors.stature_m : kMetresPerUnit * (highest - lowest);
  const float scale = mesh.stature_m / (highest - lowest);
  for (Eigen::Vector3f& p : points) p = scale * (p - Eigen::Vector3f(0.F, lowest, 0.F));
  std::vector<Eigen::Vector3f> heads;
  std::vector<Eigen::Vector3f> tails;
  for (const SkeletonBone& bone : state.skeleton) {
    heads.push_back(mean(points, bone.head));
    tails.push_back(mean(points, bone.tail));
  }
  mesh.rig = fit_rig(state.rig, heads, tails);
  mesh.rig_of = state.rig.rig_of;
  points.resize(state.surface_count);
  mesh.vertices = std::move(points);
  auto topology = std::make_shared<BodyTopology>();
  topology->triangles = state.triangles;
  topology->skin = state.skin;
  topology->fabric.assign(state.triangles.size(), Fabric::skin);
  topology->body_triangles = state.triangles.size();
  mesh.topology = topology;
  topology->part = surface_parts(mesh, SurfaceParts(body));
  check(mesh, body);
  return mesh;
}

const MakeHumanModel& builtin_bodies() {
  static const MakeHumanModel bodies = [] {
    MakeHumanModel::Files files{"base.obj", "rig.mhskel", "weights.mhw", {}};
    for (const File& file : kFiles) {
      if (file.path.ends_with(".target")) files.targets.emplace_back(file.path);
    }
    const ReadText read = [](const std::string& path) {
      return std::string(std::ranges::find(kFiles, path, &File::path)->text);
    };
    return MakeHumanModel(read, files);
  }();
  return bodies;
}

}  // namespace vesalius::synth
