#pragma once

#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// Cuts a polygon that is flat or nearly so into triangles of the same orientation, by clipping ears. Returns n - 2
/// triangles for n corners, as indices into `corners`. A polygon that crosses itself is cut in some way. In the worst
/// case the time grows with the cube of the number of corners.
std::vector<Triangle> cut_polygon(const std::vector<Eigen::Vector3f>& corners);

}  // namespace vesalius::synth
