/* The functions of libk4a and libk4arecord that the tests call, as their programs include them; fake_k4a.c has them. */
#ifndef K4A_H
#define K4A_H

#include <k4a/k4atypes.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

K4A_DECLARE_HANDLE(k4a_device_t);
K4A_DECLARE_HANDLE(k4a_playback_t);

#define K4A_DEVICE_DEFAULT 0
typedef enum { K4A_STREAM_RESULT_SUCCEEDED = 0, K4A_STREAM_RESULT_FAILED, K4A_STREAM_RESULT_EOF } k4a_stream_result_t;
typedef struct _k4a_device_configuration_t {
  k4a_image_format_t color_format;
  k4a_color_resolution_t color_resolution;
  k4a_depth_mode_t depth_mode;
  int camera_fps;
  bool synchronized_images_only;
  int32_t depth_delay_off_color_usec;
  int wired_sync_mode;
  uint32_t subordinate_delay_off_master_usec;
  bool disable_streaming_indicator;
} k4a_device_configuration_t;
static const k4a_device_configuration_t K4A_DEVICE_CONFIG_INIT_DISABLE_ALL = {
    K4A_IMAGE_FORMAT_COLOR_MJPG, K4A_COLOR_RESOLUTION_OFF, K4A_DEPTH_MODE_OFF, 2, false, 0, 0, 0, false};

k4a_result_t k4a_device_open(uint32_t index, k4a_device_t* device);
k4a_result_t k4a_device_start_cameras(k4a_device_t device, const k4a_device_configuration_t* config);
k4a_result_t k4a_device_get_calibration(k4a_device_t device, k4a_depth_mode_t depth_mode,
                                        k4a_color_resolution_t color_resolution, k4a_calibration_t* calibration);
k4a_wait_result_t k4a_device_get_capture(k4a_device_t device, k4a_capture_t* capture, int32_t timeout_in_ms);
void k4a_device_stop_cameras(k4a_device_t device);
void k4a_device_close(k4a_device_t device);

k4a_result_t k4a_playback_open(const char* path, k4a_playback_t* playback);
k4a_result_t k4a_playback_get_calibration(k4a_playback_t playback, k4a_calibration_t* calibration);
k4a_stream_result_t k4a_playback_get_next_capture(k4a_playback_t playback, k4a_capture_t* capture);
void k4a_playback_close(k4a_playback_t playback);

k4a_result_t k4a_capture_create(k4a_capture_t* capture);
void k4a_capture_reference(k4a_capture_t capture);
void k4a_capture_release(k4a_capture_t capture);
void k4a_capture_set_depth_image(k4a_capture_t capture, k4a_image_t image);
void k4a_capture_set_color_image(k4a_capture_t capture, k4a_image_t image);
k4a_image_t k4a_capture_get_depth_image(k4a_capture_t capture);
k4a_image_t k4a_capture_get_color_image(k4a_capture_t capture);

k4a_result_t k4a_image_create(k4a_image_format_t format, int width, int height, int stride, k4a_image_t* image);
void k4a_image_reference(k4a_image_t image);
void k4a_image_release(k4a_image_t image);
uint8_t* k4a_image_get_buffer(k4a_image_t image);
size_t k4a_image_get_size(k4a_image_t image);
k4a_image_format_t k4a_image_get_format(k4a_image_t image);
int k4a_image_get_width_pixels(k4a_image_t image);
int k4a_image_get_height_pixels(k4a_image_t image);
int k4a_image_get_stride_bytes(k4a_image_t image);
uint64_t k4a_image_get_device_timestamp_usec(k4a_image_t image);
uint64_t k4a_image_get_system_timestamp_nsec(k4a_image_t image);
void k4a_image_set_device_timestamp_usec(k4a_image_t image, uint64_t usec);
void k4a_image_set_system_timestamp_nsec(k4a_image_t image, uint64_t nsec);

/* Only in the tests: how many captures and pictures somebody still holds. */
int fake_k4a_held(void);

#ifdef __cplusplus
}
#endif

#endif
