#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/sensors/sensor.h"

namespace vesalius {

/// Cameras that OpenNI2's own drivers see.
std::vector<SensorInfo> list_openni2();

/// Returns frames of 640x480 at 30 a second where the camera can, else of its first mode; depth registered to colour by
/// the camera, not mirrored; colour where the camera registers. `id`: a serial number or address; empty = the only
/// camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_openni2(const std::string& id);

}  // namespace vesalius
