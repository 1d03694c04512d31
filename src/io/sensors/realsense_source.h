#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/sensors/sensor.h"

namespace vesalius {

/// RealSense cameras, by Intel's librealsense2, which is looked for when it is asked for: no build needs it. The
/// variable VESALIUS_REALSENSE names another file than librealsense2.so.
std::vector<SensorInfo> list_realsense();

/// Returns frames of 640x480 at 30 a second of the depth camera, lens undone, with colour on its grid where the camera
/// has one and the library says how the two stand. `id`: a serial number, or a file that the library is to play; empty
/// = the only camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_realsense(const std::string& id);

}  // namespace vesalius
