#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/sensors/sensor.h"

namespace vesalius {

/// Orbbec cameras (Femto, Gemini, Astra 2), by Orbbec's SDK, version 2, which is looked for when it is asked for: no
/// build needs it. The variable VESALIUS_ORBBEC names another file than libOrbbecSDK.so.2.
std::vector<SensorInfo> list_orbbec();

/// Returns frames with depth on the grid of the colour camera, as the SDK registers it, the lens of that camera undone;
/// or depth alone on its own grid, its own lens undone, of a camera without colour. 640x480 at 30 a second where the
/// camera can, else depth as it comes by default and the smallest colour of a like shape. `id`: a serial number; empty
/// = the only camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_orbbec(const std::string& id);

}  // namespace vesalius
