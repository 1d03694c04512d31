#pragma once

#include <OniCTypes.h>

#include <memory>

#include "io/sensors/run_time_library.h"

namespace vesalius::nite2 {

/// What is called of OpenNI2: the one that the program has, so that devices and frames are its own.
struct OpenniLibrary : RunTimeLibrary {
  /// `handle` is what dlopen returned, or RTLD_DEFAULT. Throws Error naming a function that is missing.
  explicit OpenniLibrary(void* handle) : RunTimeLibrary("libOpenNI2", "oni", handle) {}

  VESALIUS_FUNCTION(OniStatus, Initialize, int);
  VESALIUS_FUNCTION(const char*, GetExtendedError);
  VESALIUS_FUNCTION(OniStatus, DeviceOpen, const char*, OniDeviceHandle*);
  VESALIUS_FUNCTION(OniStatus, DeviceClose, OniDeviceHandle);
  VESALIUS_FUNCTION(OniStatus, DeviceGetProperty, OniDeviceHandle, int, void*, int*);
  VESALIUS_FUNCTION(OniStatus, DeviceCreateStream, OniDeviceHandle, OniSensorType, OniStreamHandle*);
  VESALIUS_FUNCTION(OniStatus, StreamGetProperty, OniStreamHandle, int, void*, int*);
  VESALIUS_FUNCTION(OniStatus, StreamStart, OniStreamHandle);
  VESALIUS_FUNCTION(void, StreamStop, OniStreamHandle);
  VESALIUS_FUNCTION(void, StreamDestroy, OniStreamHandle);
  VESALIUS_FUNCTION(OniStatus, WaitForAnyStream, OniStreamHandle*, int, int*, int);
  VESALIUS_FUNCTION(OniStatus, StreamReadFrame, OniStreamHandle, OniFrame**);
  VESALIUS_FUNCTION(void, FrameRelease, OniFrame*);
};

/// Returns the library: the one that $VESALIUS_OPENNI2 names; else whichever the program has loaded, visible to all or
/// not; else libOpenNI2.so.0 or libOpenNI2.so of the system. It stays for good. Throws Error if there is none.
const OpenniLibrary& openni2();

/// Throws Error with what failed and OpenNI's reason, unless the status is good.
void expect(OniStatus status, const char* what);

/// A reference to a frame, that is given back at the end.
struct ReleaseOniFrame {
  void operator()(OniFrame* frame) const { openni2().FrameRelease(frame); }
};
using OniFrameReference = std::unique_ptr<OniFrame, ReleaseOniFrame>;

}  // namespace vesalius::nite2
