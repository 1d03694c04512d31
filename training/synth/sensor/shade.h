#pragma once

#include <Eigen/Core>
#include <vector>

#include "synth/scene/scene.h"

namespace vesalius::synth {

/// Returns the colour of a material at a point of the world, by its texture. Stripes are level on upright surfaces and
/// run along z on level ones; checks and speckle are cells of space. `normal` is a unit vector in world axes.
Rgb colour_at(const Material& material, const Eigen::Vector3f& point, const Eigen::Vector3f& normal);

/// Returns the light that a white surface reflects by Lambert's law, from 0 upwards (1 = white). Lights cast no
/// shadows.
float brightness(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, const std::vector<Light>& lights,
                 float ambient);

/// Returns the colour under that light. Channels brighter than white are clamped.
Rgb lit(Rgb colour, float brightness);

}  // namespace vesalius::synth
