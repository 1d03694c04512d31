#pragma once

#include <OniCTypes.h>

#include <chrono>

#include "nite2/depth_view.h"
#include "nite2/openni_library.h"

namespace vesalius::nite2 {

/// The stream of depth of a device of OpenNI.
class DepthStream {
 public:
  /// Null is the first device there is, which is opened; others are the program's. Throws Error with OpenNI's reason.
  explicit DepthStream(OniDeviceHandle device);
  ~DepthStream();
  DepthStream(const DepthStream&) = delete;
  DepthStream& operator=(const DepthStream&) = delete;

  /// Returns the next picture; empty if there is none within this time. Throws Error with OpenNI's reason.
  OniFrameReference read(std::chrono::milliseconds patience);
  /// Returns how the stream sees now: programs may change its mode at any time.
  DepthView view() const;
  /// Returns whether it plays a recording.
  bool is_recording() const { return is_recording_; }

 private:
  template <class T>
  bool property(int id, T& value) const;

  OniDeviceHandle device_ = nullptr, opened_ = nullptr;
  OniStreamHandle stream_ = nullptr;
  bool is_recording_ = false;
};

}  // namespace vesalius::nite2
