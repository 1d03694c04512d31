#pragma once

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"

namespace vesalius::synth {

/// Pixels that a projector at (baseline_m, 0, 0) of the camera frame may fail to light: those that an edge in the same
/// row could shade, those beside a depth step, and those whose way to the projector leaves the picture. All others
/// are lit for certain, but for the shade of things thinner than a pixel; only these need a shadow ray.
/// `depth_m` along the optical axis, 0 = nothing there; such pixels are never marked.
Mask maybe_shaded(const Image<float>& depth_m, const Camera& camera, float baseline_m);

}  // namespace vesalius::synth
