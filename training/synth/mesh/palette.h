#pragma once

#include "synth/mesh/scene_mesh.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// The kinds of stuff of which things in a room are made.
enum class Stuff { wood, cloth, paint, metal, plastic, leaf, cardboard, wall, floor, glass };

/// Draws a look for a stuff: colour, pattern and infrared reflectance. Most things reflect much infrared light whatever
/// their colour; black plastic, screens and dark metal do not.
Material sample_material(Stuff stuff, Random& random);

/// Draws a colour of skin.
Rgb skin_colour(Random& random);

/// Returns the colour at a share of the way from one to another.
Rgb mix(const Rgb& from, const Rgb& to, float share);

/// Returns the colour darker or brighter by a factor, at most white.
Rgb scaled(const Rgb& colour, float factor);

/// Draws a float uniformly from [low, high). Calls stand in declarations or braces and never as two arguments of one
/// call, because compilers choose the order of arguments.
inline float between(double low, double high, Random& random) { return float(random.uniform(low, high)); }

inline bool chance(double probability, Random& random) { return random.uniform() < probability; }

/// As chance(), for options that are off by default: at 0 no random number is drawn, so that scenes are the same as
/// before the option existed.
inline bool asked(double probability, Random& random) { return probability > 0.0 && chance(probability, random); }

}  // namespace vesalius::synth
