#include "io/sensors/sensor_drivers.h"

#include <fmt/format.h>

#include <array>

#include "vesalius/error.h"

namespace vesalius {
namespace {

// CMake says which libraries it found.
constexpr std::array<SensorDriver, 4> kDrivers{
    {{"openni2", "Xtion, Carmine, Structure and other PrimeSense cameras", "libopenni2-dev", VESALIUS_OPENNI2 != 0,
      list_openni2, open_openni2},
     {"freenect", "Kinect v1", "libfreenect-dev", VESALIUS_FREENECT != 0, list_freenect, open_freenect},
     {"realsense", "RealSense", "librealsense2", true, list_realsense, open_realsense},
     {"orbbec", "Femto, Gemini, Astra 2", "libOrbbecSDK", true, list_orbbec, open_orbbec}}};

}  // namespace

std::span<const SensorDriver> sensor_drivers() { return kDrivers; }

std::unique_ptr<FrameSource> open_sensor(const SensorDriver& driver, const std::string& id) {
  if (!driver.built) {
    throw Error(
        fmt::format("{}: this build cannot open it; install {} and build again", driver.scheme, driver.package));
  }
  return driver.open(id);
}

}  // namespace vesalius
