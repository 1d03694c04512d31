#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "synth/sensor/scene_geometry.h"
#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"

namespace vesalius::synth {

/// Ray casting in a SceneGeometry: the one unit that knows Embree. Works in the calling thread alone.
class EmbreeScene {
 public:
  /// Throws Error where Embree cannot start.
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Sorts the geometry, which must live and stay as it is until the next build. Throws Error when out of memory.
  void build(const SceneGeometry& geometry);

  static constexpr std::uint32_t kNothing = 0xFFFFFFFFU;
  /// Returns what the ray through each pixel's centre meets first: 2 * quad + (0 or 1: which of its triangles), or
  /// kNothing.
  void cast(const Camera& camera, Image<std::uint32_t>& hits);

  /// Way from a surface to the projector.
  struct ShadowRay {
    Eigen::Vector3f from;
    std::uint32_t pixel;
  };
  /// Sets the pixel of every ray that reaches `projector` without meeting anything.
  void light(const std::vector<ShadowRay>& rays, const Eigen::Vector3f& projector, Mask& lit);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// "Embree 3.13.5".
const char* embree_version();

}  // namespace vesalius::synth
