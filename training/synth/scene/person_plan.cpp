#include "synth/scene/person_plan.h"

#include <algorithm>
#include <limits>

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

/// Returns the allowed error of a person's surface: `detail_px` pixels at their point nearest to the camera.
float tolerance_m(const View& view, const PosedBody& body, float detail_px) {
  constexpr float kFlesh_m = 0.3F;  // the skin is nearer to the camera than the bones
  float nearest_m = std::numeric_limits<float>::max();
  for (const auto* points : {&body.joints, &body.ends}) {
    for (const Vector3f& p : *points) nearest_m = std::min(nearest_m, (view.camera_from_world * p).z());
  }
  return detail_px * std::max(0.F, nearest_m - kFlesh_m) / std::max(view.camera.fx, view.camera.fy);
}

}  // namespace

SceneMesh person_mesh(const PersonPlan& plan, const PosedBody& body, const View& view, float detail_px) {
  const CoarseSurface* coarse =
      plan.detail != nullptr ? plan.detail->within(tolerance_m(view, body, detail_px)) : nullptr;
  const BodyTopology& topology = *plan.poser->mesh().topology;
  SceneMesh mesh;
  mesh.materials.assign(plan.look.begin(), plan.look.end());
  if (coarse != nullptr) {
    mesh.vertices.reserve(coarse->vertex.size());
    for (const std::uint32_t v : coarse->vertex) mesh.vertices.push_back(body.vertices[v]);
    mesh.triangles = coarse->triangles;
    mesh.part = coarse->part;
    mesh.material = coarse->fabric;
    return mesh;
  }
  mesh.vertices = body.vertices;
  mesh.triangles = topology.triangles;
  mesh.part = topology.part;
  mesh.material.reserve(topology.fabric.size());
  for (const Fabric fabric : topology.fabric) mesh.material.push_back(static_cast<std::uint8_t>(fabric));
  return mesh;
}

PosedBody moved(PosedBody body, const Isometry3f& motion) {
  for (auto* points : {&body.vertices, &body.parts}) {
    for (Vector3f& p : *points) p = motion * p;
  }
  for (auto* points : {&body.joints, &body.ends}) {
    for (Vector3f& p : *points) p = motion * p;
  }
  return body;
}

}  // namespace vesalius::synth
