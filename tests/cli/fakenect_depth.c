// Loaded before fakenect, which knows raw depth alone: frames that are played hold registered millimetres instead.
#include <libfreenect.h>

freenect_frame_mode freenect_find_depth_mode(freenect_resolution resolution, freenect_depth_format format) {
  freenect_frame_mode mode = {0};
  mode.resolution = resolution;
  mode.depth_format = format;
  mode.bytes = 640 * 480 * 2;
  mode.width = 640;
  mode.height = 480;
  mode.data_bits_per_pixel = 16;
  mode.framerate = 30;
  mode.is_valid = 1;
  return mode;
}
