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

// It lacks these, which the program calls where it lists cameras; Ubuntu's linker wants them at the start.
int freenect_list_device_attributes(freenect_context* context, struct freenect_device_attributes** list) {
  (void)context;
  *list = 0;
  return 0;
}

void freenect_free_device_attributes(struct freenect_device_attributes* list) { (void)list; }
