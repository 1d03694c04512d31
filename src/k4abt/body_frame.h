#pragma once

#include <k4abttypes.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "k4abt/k4a_library.h"
#include "vesalius/image.h"

namespace vesalius::k4abt {

/// What was found in a capture.
class BodyFrame {
 public:
  /// `index_map` has the size of the capture's depth, `depth` is that.
  BodyFrame(CaptureReference capture, ImageReference depth, std::vector<k4abt_body_t> bodies,
            Image<std::uint8_t> index_map);

  const std::vector<k4abt_body_t>& bodies() const { return bodies_; }
  std::uint64_t device_usec() const { return device_usec_; }
  std::uint64_t system_nsec() const { return system_nsec_; }
  k4a_capture_t capture() const { return capture_.get(); }
  /// Returns the picture of the indices of bodies, made when it is first asked for. Throws Error if libk4a makes none.
  k4a_image_t index_map() const;

 private:
  CaptureReference capture_;
  std::uint64_t device_usec_, system_nsec_;
  std::vector<k4abt_body_t> bodies_;
  mutable std::mutex mutex_;
  mutable Image<std::uint8_t> pixels_;  ///< empty once there is a picture
  mutable ImageReference picture_;
};

}  // namespace vesalius::k4abt
