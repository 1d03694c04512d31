#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "synth/sensor/scene_geometry.h"
#include "vesalius/camera.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// Casts rays in a SceneGeometry. This is the only unit that uses Embree. It works in the calling thread alone.
class EmbreeScene {
 public:
  /// Throws Error if Embree cannot start.
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Builds the search tree. The geometry must live and stay unchanged until the next build. Throws Error if memory
  /// runs out.
  void build(const SceneGeometry& geometry);

  static constexpr std::uint32_t kNothing = 0xFFFFFFFFU;
  /// Finds the first triangle that the ray through each pixel's centre meets. Its number is 2 * quad + 0 or 1, or
  /// kNothing.
  void cast(const Camera& camera, Image<std::uint32_t>& hits);

  /// The line from a surface to the projector.
  struct ShadowRay {
    Eigen::Vector3f from;
    std::uint32_t pixel;
  };
  /// Sets the pixel of every ray that reaches `projector` without meeting a surface.
  void light(const std::vector<ShadowRay>& rays, const Eigen::Vector3f& projector, Mask& lit);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the version, e.g. "Embree 3.13.5".
const char* embree_version();

}  // namespace vesalius::synth
