#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/sensors/sensor.h"

namespace vesalius {

/// Kinects of the first version.
std::vector<SensorInfo> list_freenect();

/// Returns frames of 640x480 at 30 a second with depth in millimetres that the driver registered to colour. `id`: a
/// serial number; empty = the only camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_freenect(const std::string& id);

}  // namespace vesalius
