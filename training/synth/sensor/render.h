#pragma once

#include <memory>
#include <optional>

#include "synth/scene/scene.h"

namespace vesalius::synth {

/// The images of a view without noise. All have the camera's size.
struct Rendering {
  View view;
  Image<float> depth_m;           ///< along the optical axis, metres; 0 if the ray hits nothing
  LabelImage labels;              ///< index of the part, or kBackground
  Image<std::uint8_t> person;     ///< index of the person, or kBackground
  Image<Eigen::Vector3f> normal;  ///< unit vector in the camera frame towards the camera, or zero
  ColourImage colour;             ///< empty unless requested
  Image<float> infrared;          ///< share of reflected infrared light, 0-1; 0 if the ray hits nothing
  Mask lit;                       ///< non-zero in the projector's light; empty without a projector
};

struct RenderOptions {
  bool colour = true;
  /// Position of a structured-light sensor's projector (or a stereo sensor's second eye), in metres in the camera
  /// frame.
  std::optional<Eigen::Vector3f> projector;
};

/// Casts rays with Embree. It holds a device, so each thread needs its own. The same scene and view give the same
/// bytes.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Renders a view. Throws Error for an invalid camera, or a mesh with an index out of range or a number that is not
  /// finite.
  Rendering render(const Scene& scene, const View& view, const RenderOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius::synth
