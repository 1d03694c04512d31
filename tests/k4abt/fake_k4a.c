/* A libk4a without a camera: captures and pictures in memory, counted by references, and one device that is the file
   that FAKE_K4A names; a playback is of any such file: a calibration, then for each frame its time (uint64,
   microseconds) and its depth. */

#include <k4a/k4a.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  atomic_int references;
  k4a_image_format_t format;
  int width, height, stride;
  uint64_t device_usec, system_nsec;
  uint8_t* buffer;
} Image;

typedef struct {
  atomic_int references;
  Image *depth, *colour;
} Capture;

typedef struct {
  FILE* file;
  k4a_calibration_t calibration;
} Recording;

static atomic_int held;

int fake_k4a_held(void) { return held; }

k4a_result_t k4a_image_create(k4a_image_format_t format, int width, int height, int stride, k4a_image_t* image) {
  Image* made = calloc(1, sizeof *made);
  made->references = 1;
  made->format = format;
  made->width = width, made->height = height, made->stride = stride;
  made->buffer = calloc((size_t)stride, (size_t)height);
  ++held;
  *image = (k4a_image_t)made;
  return K4A_RESULT_SUCCEEDED;
}

void k4a_image_reference(k4a_image_t image) { ++((Image*)image)->references; }

void k4a_image_release(k4a_image_t image) {
  Image* of = (Image*)image;
  if (--of->references > 0) return;
  free(of->buffer);
  free(of);
  --held;
}

uint8_t* k4a_image_get_buffer(k4a_image_t image) { return ((Image*)image)->buffer; }
size_t k4a_image_get_size(k4a_image_t image) {
  const Image* of = (const Image*)image;
  return (size_t)of->stride * (size_t)of->height;
}
k4a_image_format_t k4a_image_get_format(k4a_image_t image) { return ((Image*)image)->format; }
int k4a_image_get_width_pixels(k4a_image_t image) { return ((Image*)image)->width; }
int k4a_image_get_height_pixels(k4a_image_t image) { return ((Image*)image)->height; }
int k4a_image_get_stride_bytes(k4a_image_t image) { return ((Image*)image)->stride; }
uint64_t k4a_image_get_device_timestamp_usec(k4a_image_t image) { return ((Image*)image)->device_usec; }
uint64_t k4a_image_get_system_timestamp_nsec(k4a_image_t image) { return ((Image*)image)->system_nsec; }
void k4a_image_set_device_timestamp_usec(k4a_image_t image, uint64_t usec) { ((Image*)image)->device_usec = usec; }
void k4a_image_set_system_timestamp_nsec(k4a_image_t image, uint64_t nsec) { ((Image*)image)->system_nsec = nsec; }

k4a_result_t k4a_capture_create(k4a_capture_t* capture) {
  Capture* made = calloc(1, sizeof *made);
  made->references = 1;
  ++held;
  *capture = (k4a_capture_t)made;
  return K4A_RESULT_SUCCEEDED;
}

void k4a_capture_reference(k4a_capture_t capture) { ++((Capture*)capture)->references; }

void k4a_capture_release(k4a_capture_t capture) {
  Capture* of = (Capture*)capture;
  if (--of->references > 0) return;
  if (of->depth) k4a_image_release((k4a_image_t)of->depth);
  if (of->colour) k4a_image_release((k4a_image_t)of->colour);
  free(of);
  --held;
}

static void set(Image** to, k4a_image_t image) {
  if (image) k4a_image_reference(image);
  if (*to) k4a_image_release((k4a_image_t)*to);
  *to = (Image*)image;
}
static k4a_image_t got(Image* image) {
  if (image) k4a_image_reference((k4a_image_t)image);
  return (k4a_image_t)image;
}
void k4a_capture_set_depth_image(k4a_capture_t capture, k4a_image_t image) { set(&((Capture*)capture)->depth, image); }
void k4a_capture_set_color_image(k4a_capture_t capture, k4a_image_t image) { set(&((Capture*)capture)->colour, image); }
k4a_image_t k4a_capture_get_depth_image(k4a_capture_t capture) { return got(((Capture*)capture)->depth); }
k4a_image_t k4a_capture_get_color_image(k4a_capture_t capture) { return got(((Capture*)capture)->colour); }

k4a_result_t k4a_playback_open(const char* path, k4a_playback_t* playback) {
  FILE* file = path ? fopen(path, "rb") : NULL;
  if (!file) return K4A_RESULT_FAILED;
  Recording* made = calloc(1, sizeof *made);
  made->file = file;
  if (fread(&made->calibration, sizeof made->calibration, 1, file) != 1) abort();
  *playback = (k4a_playback_t)made;
  return K4A_RESULT_SUCCEEDED;
}

k4a_result_t k4a_playback_get_calibration(k4a_playback_t playback, k4a_calibration_t* calibration) {
  *calibration = ((Recording*)playback)->calibration;
  return K4A_RESULT_SUCCEEDED;
}

k4a_stream_result_t k4a_playback_get_next_capture(k4a_playback_t playback, k4a_capture_t* capture) {
  Recording* of = (Recording*)playback;
  uint64_t usec = 0;
  if (fread(&usec, sizeof usec, 1, of->file) != 1) return K4A_STREAM_RESULT_EOF;
  const k4a_calibration_camera_t* camera = &of->calibration.depth_camera_calibration;
  k4a_image_t depth;
  k4a_image_create(K4A_IMAGE_FORMAT_DEPTH16, camera->resolution_width, camera->resolution_height,
                   2 * camera->resolution_width, &depth);
  if (fread(k4a_image_get_buffer(depth), k4a_image_get_size(depth), 1, of->file) != 1) abort();
  k4a_image_set_device_timestamp_usec(depth, usec);
  k4a_capture_create(capture);
  k4a_capture_set_depth_image(*capture, depth);
  k4a_image_release(depth);
  return K4A_STREAM_RESULT_SUCCEEDED;
}

void k4a_playback_close(k4a_playback_t playback) {
  fclose(((Recording*)playback)->file);
  free(playback);
}

k4a_result_t k4a_device_open(uint32_t index, k4a_device_t* device) {
  return index == 0 ? k4a_playback_open(getenv("FAKE_K4A"), (k4a_playback_t*)device) : K4A_RESULT_FAILED;
}
k4a_result_t k4a_device_start_cameras(k4a_device_t device, const k4a_device_configuration_t* config) {
  return device && config->depth_mode != K4A_DEPTH_MODE_OFF ? K4A_RESULT_SUCCEEDED : K4A_RESULT_FAILED;
}
k4a_result_t k4a_device_get_calibration(k4a_device_t device, k4a_depth_mode_t depth_mode,
                                        k4a_color_resolution_t color_resolution, k4a_calibration_t* calibration) {
  (void)depth_mode, (void)color_resolution;
  return k4a_playback_get_calibration((k4a_playback_t)device, calibration);
}
k4a_wait_result_t k4a_device_get_capture(k4a_device_t device, k4a_capture_t* capture, int32_t timeout_in_ms) {
  (void)timeout_in_ms;
  const bool got_one = k4a_playback_get_next_capture((k4a_playback_t)device, capture) == K4A_STREAM_RESULT_SUCCEEDED;
  return got_one ? K4A_WAIT_RESULT_SUCCEEDED : K4A_WAIT_RESULT_FAILED;
}
void k4a_device_stop_cameras(k4a_device_t device) { (void)device; }
void k4a_device_close(k4a_device_t device) { k4a_playback_close((k4a_playback_t)device); }
