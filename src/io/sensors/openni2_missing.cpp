// In place of openni2_source.cpp where OpenNI2 was not found.
#include "io/sensors/sensor_drivers.h"

namespace vesalius {

std::vector<SensorInfo> list_openni2() { return {}; }

std::unique_ptr<FrameSource> open_openni2(const std::string& /*id*/) { return nullptr; }

}  // namespace vesalius
