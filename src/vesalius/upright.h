#pragma once

#include "vesalius/frame.h"
#include "vesalius/person.h"
#include "vesalius/prior.h"
#include "vesalius/trace.h"

// Pictures of cameras that are mounted on their side or upside down, turned clockwise by quarters. Points and
// directions are turned about the optical axis with them, so that everything still fits the camera. Turned by
// `quarters` and then by 4 - `quarters`, 0 to 3, a value is what it was.

namespace vesalius {

/// Returns by how many quarter turns a frame becomes upright: what it says itself; otherwise the nearest number where
/// the measured way up is more than 60 degrees from the picture's, else 0. Cameras that look nearly straight up or down
/// stay as they are.
int quarters_to_upright(const Frame& frame);

/// Returns where up is in a frame that is tilted by nothing once it is upright; a unit vector, optical frame.
Eigen::Vector3f guessed_up(const Frame& frame);

Eigen::Vector3f turned(const Eigen::Vector3f& vector, int quarters);
Camera turned(const Camera& camera, int quarters);
/// The frame that comes out is said to be upright.
Frame turned(const Frame& frame, int quarters);
Mask turned(const Mask& mask, int quarters);
Prior turned(Prior prior, int quarters);
/// `camera` is that of the picture before it is turned.
PictureRegion turned(PictureRegion region, const Camera& camera, int quarters);
Detection turned(Detection found, int quarters);
/// Trace::person stays as it is.
Trace turned(Trace trace, int quarters);

}  // namespace vesalius
