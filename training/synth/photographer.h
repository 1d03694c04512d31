#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "synth/recipe.h"
#include "synth/scene/build_scene.h"
#include "vesalius/frame.h"

namespace vesalius::synth {

/// Which streams of random numbers the picture of a scene uses (recipe.h).
struct PictureStreams {
  std::uint64_t frame = 0;   ///< noise of the picture
  std::uint64_t camera = 0;  ///< what a camera keeps over a recording: filter, strength of errors, exposure
  bool is_clip = false;      ///< whether those two differ
};

/// Takes pictures of scenes with the sensor of a recipe. It may be used from several threads.
class Photographer {
 public:
  /// Keeps a reference to the recipe.
  Photographer(const Recipe& recipe, std::uint64_t seed);
  ~Photographer();
  Photographer(const Photographer&) = delete;
  Photographer& operator=(const Photographer&) = delete;

  const Camera& camera() const;

  /// Returns the picture of a scene with the truth about its people and the camera.
  LabelledFrame take(const BuiltScene& built, const PictureStreams& streams, std::string name) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius::synth
