#pragma once

#include <span>

#include "io/sensors/sensor.h"

namespace vesalius {

/// Returns all drivers, those that this build lacks among them.
std::span<const SensorDriver> sensor_drivers();

/// Opens a camera by its driver. Throws Error naming the driver, and the package where this build lacks it.
std::unique_ptr<FrameSource> open_sensor(const SensorDriver& driver, const std::string& id);

}  // namespace vesalius
