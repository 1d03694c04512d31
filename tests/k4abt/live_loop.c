/* What programs of the interface do with a camera: captures in, bodies out, until the camera ends. Prints a line for
   each body: id, head in millimetres, confidence of the head, pixels. */

#include <k4a/k4a.h>
#include <k4abt.h>
#include <stdio.h>
#include <stdlib.h>

#define VERIFY(call)                        \
  if ((call) != K4A_RESULT_SUCCEEDED) {     \
    fprintf(stderr, "failed: %s\n", #call); \
    exit(1);                                \
  }

static long pixels_of(k4a_image_t index_map, uint8_t index) {
  const uint8_t* pixels = k4a_image_get_buffer(index_map);
  long count = 0;
  for (size_t i = 0; i < k4a_image_get_size(index_map); ++i) count += pixels[i] == index;
  return count;
}

static void print_bodies(k4abt_frame_t frame) {
  k4a_image_t index_map = k4abt_frame_get_body_index_map(frame);
  printf("frame %llu\n", (unsigned long long)k4abt_frame_get_device_timestamp_usec(frame));
  for (uint32_t i = 0; i < k4abt_frame_get_num_bodies(frame); ++i) {
    k4abt_body_t body;
    VERIFY(k4abt_frame_get_body_skeleton(frame, i, &body.skeleton));
    body.id = k4abt_frame_get_body_id(frame, i);
    const k4abt_joint_t* head = &body.skeleton.joints[K4ABT_JOINT_HEAD];
    printf("%u: %.3f %.3f %.3f %d, %ld\n", (unsigned)body.id, head->position.xyz.x, head->position.xyz.y,
           head->position.v[2], (int)head->confidence_level, pixels_of(index_map, (uint8_t)i));
  }
  k4a_image_release(index_map);
}

int main(void) {
  k4a_device_t device = NULL;
  VERIFY(k4a_device_open(K4A_DEVICE_DEFAULT, &device));
  k4a_device_configuration_t config = K4A_DEVICE_CONFIG_INIT_DISABLE_ALL;
  config.depth_mode = K4A_DEPTH_MODE_NFOV_UNBINNED;
  VERIFY(k4a_device_start_cameras(device, &config));
  k4a_calibration_t calibration;
  VERIFY(k4a_device_get_calibration(device, config.depth_mode, config.color_resolution, &calibration));
  k4abt_tracker_t tracker = NULL;
  k4abt_tracker_configuration_t tracker_config = K4ABT_TRACKER_CONFIG_DEFAULT;
  VERIFY(k4abt_tracker_create(&calibration, tracker_config, &tracker));
  k4a_capture_t capture = NULL;
  while (k4a_device_get_capture(device, &capture, K4A_WAIT_INFINITE) == K4A_WAIT_RESULT_SUCCEEDED) {
    const k4a_wait_result_t queued = k4abt_tracker_enqueue_capture(tracker, capture, K4A_WAIT_INFINITE);
    k4a_capture_release(capture);
    k4abt_frame_t frame = NULL;
    if (queued != K4A_WAIT_RESULT_SUCCEEDED ||
        k4abt_tracker_pop_result(tracker, &frame, K4A_WAIT_INFINITE) != K4A_WAIT_RESULT_SUCCEEDED) {
      return 1;
    }
    print_bodies(frame);
    k4abt_frame_release(frame);
  }
  k4abt_tracker_shutdown(tracker);
  k4abt_tracker_destroy(tracker);
  k4a_device_stop_cameras(device);
  k4a_device_close(device);
  return 0;
}
