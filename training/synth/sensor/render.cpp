#include "synth/sensor/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "synth/sensor/camera_rays.h"
#include "synth/sensor/embree_scene.h"
#include "synth/sensor/occlusion.h"
#include "synth/sensor/scene_geometry.h"
#include "synth/sensor/shade.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kOffSurface_m = 0.0005F;  ///< shadow rays start at this distance, so no surface shades itself
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;

void check(const View& view, const RenderOptions& options) {
  vesalius::check(view.camera);
  if (static_cast<std::int64_t>(view.camera.width) * view.camera.height > kMaxPixels) {
    throw Error(fmt::format("camera: {} x {} pixels, expected at most {} in all", view.camera.width, view.camera.height,
                            kMaxPixels));
  }
  if (options.projector && !options.projector->allFinite()) throw Error("projector: its place is not finite");
}

void check(const Scene& scene) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (light.position.allFinite() && light.strength >= 0.F && std::isfinite(light.strength)) continue;
    throw Error(fmt::format("light {}: expected a finite place and a strength of 0 or more", i));
  }
  if (!(scene.ambient >= 0.F && std::isfinite(scene.ambient))) throw Error("ambient light: expected 0 or more");
}

/// The triangle that a ray hit. The hit point is computed again from its plane: Embree identifies the triangle, but its
/// distance depends on the processor's instructions.
struct Met {
  std::uint32_t hit = EmbreeScene::kNothing;
  Face face;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< normal, of any length
  double offset = 0.0;
  float near_m = 0.F, far_m = 0.F;  ///< extent along the optical axis, metres
  bool has_area = false;
  float infrared = 0.F;
  Eigen::Vector3f towards = Eigen::Vector3f::Zero();  ///< unit normal, to the camera's side

  void look_up(const SceneGeometry& geometry, std::uint32_t of) {
    hit = of;
    const SceneGeometry::Quad& quad = geometry.quads[hit / 2];
    const bool second = (hit & 1U) != 0;
    const Eigen::Vector3f& a = geometry.vertices[second ? quad[2] : quad[0]];
    const Eigen::Vector3f& b = geometry.vertices[second ? quad[3] : quad[1]];
    const Eigen::Vector3f& c = geometry.vertices[second ? quad[1] : quad[3]];
    const Eigen::Vector3d corner = a.cast<double>();
    normal = (b.cast<double>() - corner).cross(c.cast<double>() - corner);
    offset = normal.dot(corner);
    near_m = std::min({a.z(), b.z(), c.z()});
    far_m = std::max({a.z(), b.z(), c.z()});
    towards = (normal * ((offset > 0.0 ? -1.0 : 1.0) / normal.norm())).cast<float>();
    has_area = towards.allFinite();
    face = geometry.faces[hit / 2][hit & 1U];
    infrared = geometry.materials[face.material].infrared;
  }

  /// Returns the depth at which the ray (x, y, 1) meets the plane.
  float depth_of(float ray_x, float ray_y) const {
    const double along = normal.x() * ray_x + normal.y() * ray_y + normal.z();
    return std::clamp(float(offset / along), near_m, far_m);
  }
};

}  // namespace

struct Renderer::State {
  SceneGeometry geometry;
  EmbreeScene embree;
  Image<std::uint32_t> hits;
  std::vector<EmbreeScene::ShadowRay> shadow_rays;

  void fill_surfaces(Rendering& out) const;
  void fill_colour(const Scene& scene, Rendering& out) const;
  void fill_lit(const Eigen::Vector3f& projector, Rendering& out);
};

void Renderer::State::fill_surfaces(Rendering& out) const {
  const Camera& camera = out.view.camera;
  const CameraRays rays(camera);
  Met met;  // kept, since neighbours often hit the same triangle
  for (int v = 0; v < camera.height; ++v) {
    const std::uint32_t* hit = hits.row(v);
    float* depth = out.depth_m.row(v);
    float* infrared = out.infrared.row(v);
    Eigen::Vector3f* normal = out.normal.row(v);
    std::uint8_t* label = out.labels.row(v);
    std::uint8_t* person = out.person.row(v);
    for (int u = 0; u < camera.width; ++u) {
      if (hit[u] == EmbreeScene::kNothing) continue;
      if (hit[u] != met.hit) met.look_up(geometry, hit[u]);
      const float depth_m = met.depth_of(rays.x(u), rays.y(v));
      if (!(depth_m > 0.F && met.has_area)) continue;  // a triangle without area that was hit on its edge
      depth[u] = depth_m;
      normal[u] = met.towards;
      label[u] = met.face.part;
      person[u] = met.face.person;
      infrared[u] = met.infrared;
    }
  }
}

void Renderer::State::fill_colour(const Scene& scene, Rendering& out) const {
  const Camera& camera = out.view.camera;
  const Eigen::Isometry3f world_from_camera = out.view.camera_from_world.inverse();
  out.colour = ColourImage(camera.width, camera.height, scene.sky);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (out.depth_m(u, v) == 0.F) continue;
      const std::uint32_t hit = hits(u, v);
      const Material& material = geometry.materials[geometry.faces[hit / 2][hit & 1U].material];
      const Eigen::Vector3f at = world_from_camera * camera.point(float(u), float(v), out.depth_m(u, v));
      const Eigen::Vector3f normal = world_from_camera.linear() * out.normal(u, v);
      out.colour(u, v) =
          synth::lit(colour_at(material, at, normal), brightness(at, normal, scene.lights, scene.ambient));
    }
  }
}

void Renderer::State::fill_lit(const Eigen::Vector3f& projector, Rendering& out) {
  const Camera& camera = out.view.camera;
  const bool beside = projector.y() == 0.F && projector.z() == 0.F && projector.x() != 0.F;
  const CameraRays rays(camera);
  const auto at = [&](int u, int v, float depth_m) {
    return Eigen::Vector3f(rays.x(u) * depth_m, rays.y(v) * depth_m, depth_m);
  };
  out.lit = Mask(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    const float* depth_m = out.depth_m.row(v);
    const Eigen::Vector3f* normal = out.normal.row(v);  // zero if there is no surface
    std::uint8_t* lit = out.lit.row(v);
    for (int u = 0; u < camera.width; ++u) lit[u] = normal[u].dot(projector - at(u, v, depth_m[u])) > 0.F ? 1 : 0;
  }
  const Mask uncertain = beside ? maybe_shaded(out.depth_m, camera, projector.x()) : out.lit;
  shadow_rays.clear();
  // Pixels are taken column by column within some rows. The rays of a packet are then close together, which is faster.
  constexpr int kRows = 4;
  for (int top = 0; top < camera.height; top += kRows) {
    const int bottom = std::min(top + kRows, camera.height);
    for (int u = 0; u < camera.width; ++u) {
      for (int v = top; v < bottom; ++v) {
        if ((uncertain(u, v) & out.lit(u, v)) == 0) continue;
        out.lit(u, v) = 0;
        shadow_rays.push_back({at(u, v, out.depth_m(u, v)) + kOffSurface_m * out.normal(u, v),
                               static_cast<std::uint32_t>(v * camera.width + u)});
      }
    }
  }
  embree.light(shadow_rays, projector, out.lit);
}

Renderer::Renderer() : state_(std::make_unique<State>()) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Rendering Renderer::render(const Scene& scene, const View& view, const RenderOptions& options) {
  check(view, options);
  check(scene);
  State& state = *state_;
  state.geometry.gather(scene, view, options.projector);
  state.embree.build(state.geometry);
  const int width = view.camera.width, height = view.camera.height;
  if (state.hits.width() != width || state.hits.height() != height) state.hits = Image<std::uint32_t>(width, height);
  state.embree.cast(view.camera, state.hits);

  Rendering out;
  out.view = view;
  out.depth_m = Image<float>(width, height);
  out.labels = LabelImage(width, height, kBackground);
  out.person = Image<std::uint8_t>(width, height, kBackground);
  out.normal = Image<Eigen::Vector3f>(width, height, Eigen::Vector3f::Zero());
  out.infrared = Image<float>(width, height);
  state.fill_surfaces(out);
  if (options.colour) state.fill_colour(scene, out);
  if (options.projector) state.fill_lit(*options.projector, out);
  return out;
}

}  // namespace vesalius::synth
