#pragma once

#include <memory>
#include <optional>

#include "synth/scene/scene.h"

namespace vesalius::synth {

/// The images of a view, free of noise. All images have the camera's size.
struct Rendering {
  View view;
  Image<float> depth_m;           ///< along the optical axis, metres; 0 where no surface is hit
  LabelImage labels;              ///< part, kBackground elsewhere
  Image<std::uint8_t> person;     ///< index of the person, kBackground elsewhere
  Image<Eigen::Vector3f> normal;  ///< unit, camera frame, towards the camera; zero where no surface is hit
  ColourImage colour;             ///< empty unless asked for
  Image<float> infrared;          ///< share of infrared light sent back, 0-1; 0 where no surface is hit
  Mask lit;                       ///< non-zero where the projector's light arrives; empty without a projector
};

struct RenderOptions {
  bool colour = true;
  /// Where the pattern of a structured-light sensor (or the second eye of a stereo one) sits, camera frame, metres.
  std::optional<Eigen::Vector3f> projector;
};

/// Casts rays with Embree. Holds a device; use one per thread. Same scene and view, same bytes.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Throws Error for a camera that cannot be, or a mesh with an index out of range or a number that is not finite.
  Rendering render(const Scene& scene, const View& view, const RenderOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// "Embree 3.13.5".
const char* renderer_version();

}  // namespace vesalius::synth
