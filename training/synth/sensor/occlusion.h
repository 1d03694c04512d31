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

/// Returns the pixels that a projector at (baseline_m, 0, 0) of the camera frame may fail to light: those that an edge
/// in the same row could shade, those beside a depth step, and those whose line to the projector leaves the picture.
/// Only these need a shadow ray. All others are certainly lit, unless something thinner than a pixel shades them.
/// `depth_m` is along the optical axis, 0 = no surface; pixels without a surface are never marked.
Mask maybe_shaded(const Image<float>& depth_m, const Camera& camera, float baseline_m);

}  // namespace vesalius::synth
