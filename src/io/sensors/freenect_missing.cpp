// In place of freenect_source.cpp where libfreenect was not found.
#include "io/sensors/sensor_drivers.h"

namespace vesalius {

std::vector<SensorInfo> list_freenect() { return {}; }

std::unique_ptr<FrameSource> open_freenect(const std::string& /*id*/) { return nullptr; }

}  // namespace vesalius
