#include "synth/scene/model_import.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include "synth/scene/gltf_model.h"
#include "synth/scene/model_mesh.h"
#include "synth/scene/obj_model.h"
#include "synth/text/text_scanner.h"
#include "vesalius/base/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr float kSmallest_m = 0.01F, kLargest_m = 20.F;

/// Scales the mesh to metres, turns y upwards and places it on the floor about the origin.
void settle(const ModelFiles& files, const ImportOptions& options, SceneMesh& mesh) {
  for (Vector3f& p : mesh.vertices) {
    if (options.z_up) p = Vector3f(p.x(), p.z(), -p.y());
    p *= options.metres_per_unit;
  }
  Eigen::AlignedBox3f bounds;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) bounds.extend(mesh.vertices[corner]);
  }
  const float size = bounds.sizes().maxCoeff();
  if (!(size >= kSmallest_m && size <= kLargest_m)) {
    files.fail(fmt::format("is {} m in size, expected {} to {}: see the scale", size, kSmallest_m, kLargest_m));
  }
  const Vector3f foot(bounds.center().x(), bounds.min().y(), bounds.center().z());
  for (Vector3f& p : mesh.vertices) p -= foot;
}

}  // namespace

SceneMesh import_model(const std::string& path, const ReadText& read, const ImportOptions& options) {
  if (!(std::isfinite(options.metres_per_unit) && options.metres_per_unit > 0.F)) {
    throw UsageError(fmt::format("scale of a model is {}, expected above 0", options.metres_per_unit));
  }
  const std::string ending = std::filesystem::path(path).extension().string();
  const bool obj = same_word(ending, ".obj");
  ModelFiles files(path, read);
  if (!obj && !same_word(ending, ".gltf") && !same_word(ending, ".glb")) {
    files.fail("expected a .obj, .gltf or .glb file");
  }
  ModelMesh limited(files, options.max_triangles);
  (obj ? read_obj_model : read_gltf_model)(files, limited);
  SceneMesh mesh = limited.take();
  if (mesh.triangles.empty()) files.fail("has no triangles");
  settle(files, options, mesh);
  return mesh;
}

}  // namespace vesalius::synth
