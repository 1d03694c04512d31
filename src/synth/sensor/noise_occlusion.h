#pragma once

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"

namespace vesalius::synth {

/// Non-zero where an eye moved by `eye_m` metres along the camera's x axis does not see what the camera sees, because
/// something else that the camera sees is in front. `depth_m`: 0 where there is no surface.
Mask hidden_from_eye(const Image<float>& depth_m, const Camera& camera, float eye_m);

/// Non-zero within `radius` rows and columns of two neighbours whose depths differ by more than `jump_m`, or of which
/// one has no surface.
Mask near_jumps(const Image<float>& depth_m, float jump_m, int radius);

/// Depth of the nearest surface within `radius` pixels (a square); infinity where there is none.
Image<float> nearest_within(const Image<float>& depth_m, int radius);

}  // namespace vesalius::synth
