#pragma once

#include <cstdint>
#include <string>

#include "synth/generate.h"

namespace vesalius::synth {

struct FleshFitOptions {
  int bodies = 200;    ///< bodies drawn from the generator's recipe
  int poses = 30000;   ///< drawn as the generator does
  int shapes = 8;      ///< factors of the bodies' shapes
  int components = 5;  ///< Gaussians for each limb
  std::uint64_t seed = 1;
};

/// Returns the text of a flesh model (vesalius/fit/flesh_model.h) measured on the generator's bodies and poses: the
/// mean body with the principal factors in which bodies differ, with clothes and hair, and mixtures of Gaussians over
/// the rotations of each limb's bones (expectation maximisation). Left and right are measured together.
std::string fitted_flesh_toml(const Generator& generator, const FleshFitOptions& options);

}  // namespace vesalius::synth
