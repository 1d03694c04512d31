#pragma once

#include "synth/furniture/furniture.h"

namespace vesalius::synth {

/// Adds a sleeve that hangs from a shoulder, at the side of x that `side` (1 or -1) says. It is not solid.
void hang_sleeve(FurnitureBuilder& piece, const Eigen::Vector3f& shoulder, float side, std::uint8_t cloth,
                 Random& random);

/// Adds a coat, a jacket or a dress with folds that hangs from a point, `length_m` long, with its front to +z. It is
/// solid and reaches 0.1 m to the back.
void hang_garment(FurnitureBuilder& piece, const Eigen::Vector3f& from, float length_m, Random& random);

/// Adds a jacket over the top of a chair's back, which is `width_m` wide and ends at `top`. Sleeves hang beside it. It
/// is not solid: it covers a chair that is.
void cover_chair_back(FurnitureBuilder& chair, const Eigen::Vector3f& top, float width_m, Random& random);

}  // namespace vesalius::synth
