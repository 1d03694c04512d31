#pragma once

#include "synth/furniture/furniture_builder.h"

namespace vesalius::synth {

/// Adds a coat, a jacket or a dress with folds that hangs from a point, `length_m` long, with its front to +z. It is
/// solid and reaches 0.1 m to the back.
void hang_garment(FurnitureBuilder& piece, const Eigen::Vector3f& from, float length_m, Random& random);

/// Adds a jacket over the top of a chair's back, which is `width_m` wide and ends at `top`. Sleeves hang beside it. It
/// is not solid: it covers a chair that is.
void cover_chair_back(FurnitureBuilder& chair, const Eigen::Vector3f& top, float width_m, Random& random);

/// Adds a crumpled blanket: several flat cushions, one over the other, within the given half sizes. It is not solid.
void crumple_blanket(FurnitureBuilder& piece, const Eigen::Vector3f& centre, const Eigen::Vector3f& half,
                     Random& random);

}  // namespace vesalius::synth
