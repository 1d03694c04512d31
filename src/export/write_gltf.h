#pragma once

#include <string>
#include <vector>

#include "export/moving_skeleton.h"

namespace vesalius {

/// Skeletons as binary glTF 2.0: nodes with an animation, metres, each frame's body as it was fitted. Whose shape is
/// known has flesh besides: a skinned mesh whose morph targets are the flesh model's shapes, and which is not to be
/// seen while the person is away.
std::string to_glb(const std::vector<MovingSkeleton>& skeletons);

}  // namespace vesalius
