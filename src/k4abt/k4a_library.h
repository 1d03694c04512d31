#pragma once

#include <k4a/k4atypes.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "io/sensors/run_time_library.h"

namespace vesalius::k4abt {

/// What is called of libk4a: the one that the program has, so that captures and pictures are its own.
struct K4aLibrary : RunTimeLibrary {
  /// `handle` is what dlopen returned, or RTLD_DEFAULT. Throws Error naming a function that is missing.
  explicit K4aLibrary(void* handle) : RunTimeLibrary("libk4a", "k4a_", handle) {}

  VESALIUS_FUNCTION(k4a_image_t, capture_get_depth_image, k4a_capture_t);
  VESALIUS_FUNCTION(k4a_image_t, capture_get_color_image, k4a_capture_t);
  VESALIUS_FUNCTION(void, capture_reference, k4a_capture_t);
  VESALIUS_FUNCTION(void, capture_release, k4a_capture_t);
  VESALIUS_FUNCTION(k4a_result_t, image_create, k4a_image_format_t, int, int, int, k4a_image_t*);
  VESALIUS_FUNCTION(std::uint8_t*, image_get_buffer, k4a_image_t);
  VESALIUS_FUNCTION(std::size_t, image_get_size, k4a_image_t);
  VESALIUS_FUNCTION(k4a_image_format_t, image_get_format, k4a_image_t);
  VESALIUS_FUNCTION(int, image_get_width_pixels, k4a_image_t);
  VESALIUS_FUNCTION(int, image_get_height_pixels, k4a_image_t);
  VESALIUS_FUNCTION(int, image_get_stride_bytes, k4a_image_t);
  VESALIUS_FUNCTION(std::uint64_t, image_get_device_timestamp_usec, k4a_image_t);
  VESALIUS_FUNCTION(std::uint64_t, image_get_system_timestamp_nsec, k4a_image_t);
  VESALIUS_FUNCTION(void, image_set_device_timestamp_usec, k4a_image_t, std::uint64_t);
  VESALIUS_FUNCTION(void, image_set_system_timestamp_nsec, k4a_image_t, std::uint64_t);
  VESALIUS_FUNCTION(void, image_reference, k4a_image_t);
  VESALIUS_FUNCTION(void, image_release, k4a_image_t);
};

/// Returns the library: the one that $VESALIUS_K4A names; else whichever the program has loaded, visible to all or not;
/// else libk4a.so.1.4 or libk4a.so of the system. It stays for good. Throws Error if there is none.
const K4aLibrary& k4a();

/// A reference to a capture or a picture, that is given back at the end.
struct ReleaseCapture {
  void operator()(k4a_capture_t capture) const { k4a().capture_release(capture); }
};
struct ReleaseImage {
  void operator()(k4a_image_t image) const { k4a().image_release(image); }
};
using CaptureReference = std::unique_ptr<std::remove_pointer_t<k4a_capture_t>, ReleaseCapture>;
using ImageReference = std::unique_ptr<std::remove_pointer_t<k4a_image_t>, ReleaseImage>;

}  // namespace vesalius::k4abt
