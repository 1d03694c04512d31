#pragma once

#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// Cuts a polygon, flat or nearly so, into triangles of the same turn by clipping ears; the result's numbers are
/// indices in `corners`, n - 2 triangles for n corners. A polygon that crosses itself is cut anyhow. The time grows
/// with the cube of the number of corners at worst.
std::vector<Triangle> cut_polygon(const std::vector<Eigen::Vector3f>& corners);

}  // namespace vesalius::synth
