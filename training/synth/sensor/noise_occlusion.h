#pragma once

#include "vesalius/camera.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// Returns a mask that is non-zero where an eye at `eye_m` metres along the camera's x axis does not see a surface that
/// the camera sees, because another surface that the camera sees is in front. `depth_m` is 0 if there is no surface.
Mask hidden_from_eye(const Image<float>& depth_m, const Camera& camera, float eye_m);

/// Returns a mask that is non-zero within `radius` rows and columns of two neighbours whose depths differ by more than
/// `jump_m` or of which only one has a surface.
Mask near_jumps(const Image<float>& depth_m, float jump_m, int radius);

/// Returns the depth of the nearest surface within `radius` pixels (a square), or infinity if there is none.
Image<float> nearest_within(const Image<float>& depth_m, int radius);

}  // namespace vesalius::synth
