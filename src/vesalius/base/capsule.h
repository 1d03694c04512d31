#pragma once

#include "vesalius/camera.h"
#include "vesalius/image.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns the part of the camera's picture in which points of a capsule can be seen. If it is nearer than its own
/// radius, that may be the whole picture.
Box box_around(const Capsule& capsule, const Camera& camera);

}  // namespace vesalius
