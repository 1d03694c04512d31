#pragma once

#include <Eigen/Core>
#include <vector>

#include "synth/scene/scene.h"

namespace vesalius::synth {

/// Colour of a material at a point of the world, by its texture: stripes run level on upright surfaces and along z on
/// level ones; checks and speckle are cells of space. `normal` in world axes, unit.
Rgb colour_at(const Material& material, const Eigen::Vector3f& point, const Eigen::Vector3f& normal);

/// Light that a white surface sends back by Lambert's law, 0 upwards (1 = white). No light casts a shadow.
float brightness(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, const std::vector<Light>& lights,
                 float ambient);

/// The colour under that light; what is brighter than white is white.
Rgb lit(Rgb colour, float brightness);

}  // namespace vesalius::synth
