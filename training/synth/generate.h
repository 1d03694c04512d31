#pragma once

#include <cstdint>
#include <memory>

#include "synth/bodies_and_motions.h"
#include "synth/recipe.h"
#include "synth/scene/build_scene.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"

namespace vesalius::synth {

/// Makes labelled frames of people in rooms as a sensor sees them. Frame i depends only on (recipe, assets, seed, i),
/// so any frame can be made again, in any order and on any number of threads. It may be used from several threads.
class Generator {
 public:
  /// Throws UsageError for an invalid recipe, and Error if it requires bodies that the assets lack.
  Generator(const Recipe& recipe, BodiesAndMotions assets, const BodyModel& body, std::uint64_t seed);
  ~Generator();
  Generator(const Generator&) = delete;
  Generator& operator=(const Generator&) = delete;

  /// Returns a frame with its parts, the joints of joint_names(), postures, the upward direction and the
  /// camera's pose in the scene.
  LabelledFrame frame(std::uint64_t index) const;
  /// Returns the scene of that frame.
  BuiltScene scene(std::uint64_t index) const;

  /// Returns body k of the recipe, below its body.count, with its clothes.
  const Poser& body(std::size_t k) const;
  /// Draws a pose as frames do.
  SampledPose draw_pose(Random& random) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius::synth
