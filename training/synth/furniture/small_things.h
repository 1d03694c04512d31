#pragma once

#include "synth/furniture/furniture_builder.h"

namespace vesalius::synth {

/// Adds small things to a top with the given half sides: cups, bottles, boxes and crumpled things. They are not solid.
void add_small_things(FurnitureBuilder& table, float half_x, float half_z, float height_m, Random& random);

}  // namespace vesalius::synth
