#include "nite2/depth_stream.h"

#include <string>
#include <thread>

#include "nite2/guard.h"
#include "vesalius/error.h"

namespace vesalius::nite2 {
namespace {

/// How long a stopped stream is kept. Some drivers (OpenNI2's own Dummy) go on with it for the rest of a frame.
constexpr std::chrono::milliseconds kUntilThreadsEnd(200);

}  // namespace

DepthStream::DepthStream(OniDeviceHandle device) : device_(device) {
  if (device_ == nullptr) {
    expect(openni2().DeviceOpen(nullptr, &opened_), "no device can be opened");
    device_ = opened_;
  }
  try {
    float speed = 0.F;
    int size = sizeof speed;
    is_recording_ =
        openni2().DeviceGetProperty(device_, ONI_DEVICE_PROPERTY_PLAYBACK_SPEED, &speed, &size) == ONI_STATUS_OK;
    expect(openni2().DeviceCreateStream(device_, ONI_SENSOR_DEPTH, &stream_), "the device has no depth");
    expect(openni2().StreamStart(stream_), "depth does not start");
  } catch (...) {
    if (stream_ != nullptr) openni2().StreamDestroy(stream_);
    if (opened_ != nullptr) openni2().DeviceClose(opened_);
    throw;
  }
}

DepthStream::~DepthStream() {
  openni2().StreamStop(stream_);
  std::this_thread::sleep_for(kUntilThreadsEnd);
  openni2().StreamDestroy(stream_);
  if (opened_ != nullptr) openni2().DeviceClose(opened_);
}

OniFrameReference DepthStream::read(std::chrono::milliseconds patience) {
  int ready = -1;
  const OniStatus waited = openni2().WaitForAnyStream(&stream_, 1, &ready, int(patience.count()));
  if (waited == ONI_STATUS_TIME_OUT) return nullptr;
  expect(waited, "depth does not come");
  OniFrame* frame = nullptr;
  expect(openni2().StreamReadFrame(stream_, &frame), "depth is not read");
  return OniFrameReference(frame);
}

template <class T>
bool DepthStream::property(int id, T& value) const {
  int size = sizeof value;
  return openni2().StreamGetProperty(stream_, id, &value, &size) == ONI_STATUS_OK && size == int(sizeof value);
}

DepthView DepthStream::view() const {
  OniVideoMode mode{};
  if (!property(ONI_STREAM_PROPERTY_VIDEO_MODE, mode) || mode.resolutionX <= 0 || mode.resolutionY <= 0) {
    throw Error("OpenNI says no size of depth");
  }
  DepthView view{.width = mode.resolutionX, .height = mode.resolutionY};
  const bool known = property(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, view.across_rad) &&
                     property(ONI_STREAM_PROPERTY_VERTICAL_FOV, view.down_rad);
  if (!known || !(view.across_rad > 0.F && view.down_rad > 0.F)) {
    // Of PrimeSense's cameras.
    view.across_rad = 1.0226F;
    view.down_rad = 0.7966F;
    kGuard.say_once("the camera says no field of view; that of PrimeSense's cameras is taken");
  }
  OniBool mirrored = 0;
  view.mirrored = property(ONI_STREAM_PROPERTY_MIRRORING, mirrored) && mirrored != 0;
  return view;
}

}  // namespace vesalius::nite2
