#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/sensors/sensor.h"

namespace vesalius {

/// Returns all drivers, those that this build lacks among them.
std::span<const SensorDriver> sensor_drivers();

/// Opens a camera by its driver. Throws Error naming the driver, and the package where this build lacks it.
std::unique_ptr<FrameSource> open_sensor(const SensorDriver& driver, const std::string& id);

/// Kinects of the first version.
std::vector<SensorInfo> list_freenect();

/// Returns frames of 640x480 at 30 a second with depth in millimetres that the driver registered to colour. `id`: a
/// serial number; empty = the only camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_freenect(const std::string& id);

/// Cameras that OpenNI2's own drivers see.
std::vector<SensorInfo> list_openni2();

/// Returns frames of 640x480 at 30 a second where the camera can, else of its first mode; depth registered to colour by
/// the camera, not mirrored; colour where the camera registers. `id`: a serial number or address; empty = the only
/// camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_openni2(const std::string& id);

/// Orbbec cameras (Femto, Gemini, Astra 2), by Orbbec's SDK, version 2, which is looked for when it is asked for: no
/// build needs it. The variable VESALIUS_ORBBEC names another file than libOrbbecSDK.so.2.
std::vector<SensorInfo> list_orbbec();

/// Returns frames with depth on the grid of the colour camera, as the SDK registers it, the lens of that camera undone;
/// or depth alone on its own grid, its own lens undone, of a camera without colour. 640x480 at 30 a second where the
/// camera can, else depth as it comes by default and the smallest colour of a like shape. `id`: a serial number; empty
/// = the only camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_orbbec(const std::string& id);

/// RealSense cameras, by Intel's librealsense2, which is looked for when it is asked for: no build needs it. The
/// variable VESALIUS_REALSENSE names another file than librealsense2.so.
std::vector<SensorInfo> list_realsense();

/// Returns frames of 640x480 at 30 a second of the depth camera, lens undone, with colour on its grid where the camera
/// has one and the library says how the two stand. `id`: a serial number, or a file that the library is to play; empty
/// = the only camera. Throws Error saying what is missing.
std::unique_ptr<FrameSource> open_realsense(const std::string& id);

}  // namespace vesalius
