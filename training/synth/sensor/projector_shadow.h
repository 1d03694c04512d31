#pragma once

#include "vesalius/camera.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// Returns the pixels that a projector at (baseline_m, 0, 0) of the camera frame may fail to light: those that an edge
/// in the same row could shade, those beside a depth step, and those whose line to the projector leaves the picture.
/// Only these need a shadow ray. All others are certainly lit, unless something thinner than a pixel shades them.
/// `depth_m` is along the optical axis, 0 = no surface; pixels without a surface are never marked.
Mask maybe_shaded(const Image<float>& depth_m, const Camera& camera, float baseline_m);

}  // namespace vesalius::synth
