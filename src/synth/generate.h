#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "synth/body/makehuman.h"
#include "synth/recipe.h"
#include "vesalius/base/frame.h"

namespace vesalius::synth {

/// What comes from files: all optional.
struct Assets {
  std::shared_ptr<const MakeHumanModel> makehuman;
  std::vector<SampledPose> captured;  ///< poses from motion capture
  std::vector<SceneMesh> models;      ///< furniture of the user's
};

/// Makes labelled frames of people in rooms as a sensor sees them. Frame i is a function of (recipe, assets, seed, i)
/// alone: any can be made again by itself, in any order, on any number of threads. Safe to call from several threads.
class Generator {
 public:
  /// Throws UsageError for a recipe that cannot be meant, Error where it asks for bodies that the assets lack.
  Generator(const Recipe& recipe, Assets assets, const BodyModel& body, std::uint64_t seed);
  ~Generator();
  Generator(const Generator&) = delete;
  Generator& operator=(const Generator&) = delete;

  /// With parts, and joints as joint_names() lists them.
  LabelledFrame frame(std::uint64_t index) const;
  /// What that frame looks at.
  BuiltScene scene(std::uint64_t index) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius::synth
