#pragma once

#include "synth/scene/scene.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Kinds of stuff that things in a room are made of.
enum class Stuff { wood, cloth, paint, metal, plastic, leaf, cardboard, wall, floor, glass };

/// A look that this stuff may have: colour, pattern, and how well it sends infrared light back. Most things are pale
/// in the infrared whatever their colour; black plastic, screens and dark metal are not.
Material sample_material(Stuff stuff, Random& random);

/// Uniform over [low, high), as float. Draws stand in declarations or braces, never side by side in a call, whose order
/// is the compiler's.
inline float between(double low, double high, Random& random) { return static_cast<float>(random.uniform(low, high)); }

inline bool chance(double probability, Random& random) { return random.uniform() < probability; }

}  // namespace vesalius::synth
