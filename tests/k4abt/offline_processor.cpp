// What programs of the interface do with a recording: it is read as fast as there is room, and the bodies are taken out
// as they come. offline_processor FILE; prints what live_loop prints.

#include <k4a/k4a.h>
#include <k4abt.h>

#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

std::vector<long> overlay(k4abt_frame_t frame) {
  std::vector<long> pixels(256);
  const k4a_image_t map = k4abt_frame_get_body_index_map(frame);
  const k4a_capture_t capture = k4abt_frame_get_capture(frame);
  const k4a_image_t depth = k4a_capture_get_depth_image(capture);
  for (int v = 0; v < k4a_image_get_height_pixels(depth); ++v) {
    const std::uint8_t* row = k4a_image_get_buffer(map) + v * k4a_image_get_stride_bytes(map);
    for (int u = 0; u < k4a_image_get_width_pixels(depth); ++u) ++pixels[row[u]];
  }
  k4a_image_release(depth);
  k4a_capture_release(capture);
  k4a_image_release(map);
  return pixels;
}

bool print_next(k4abt_tracker_t tracker, std::int32_t timeout_ms) {
  k4abt_frame_t frame = nullptr;
  if (k4abt_tracker_pop_result(tracker, &frame, timeout_ms) != K4A_WAIT_RESULT_SUCCEEDED) return false;
  std::printf("frame %llu\n", static_cast<unsigned long long>(k4abt_frame_get_device_timestamp_usec(frame)));
  const std::vector<long> pixels = overlay(frame);
  for (std::uint32_t i = 0; i < k4abt_frame_get_num_bodies(frame); ++i) {
    k4abt_body_t body;
    body.id = k4abt_frame_get_body_id(frame, i);
    if (k4abt_frame_get_body_skeleton(frame, i, &body.skeleton) != K4A_RESULT_SUCCEEDED) return false;
    const k4abt_joint_t& head = body.skeleton.joints[K4ABT_JOINT_HEAD];
    std::printf("%u: %.3f %.3f %.3f %d, %ld\n", body.id, static_cast<double>(head.position.v[0]),
                static_cast<double>(head.position.v[1]), static_cast<double>(head.position.v[2]),
                static_cast<int>(head.confidence_level), pixels[i]);
  }
  k4abt_frame_release(frame);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  k4a_playback_t playback = nullptr;
  k4a_calibration_t calibration;
  if (argc != 2 || k4a_playback_open(argv[1], &playback) != K4A_RESULT_SUCCEEDED ||
      k4a_playback_get_calibration(playback, &calibration) != K4A_RESULT_SUCCEEDED) {
    return 2;
  }
  k4abt_tracker_t tracker = nullptr;
  k4abt_tracker_configuration_t config = K4ABT_TRACKER_CONFIG_DEFAULT;
  config.processing_mode = K4ABT_TRACKER_PROCESSING_MODE_CPU;
  if (k4abt_tracker_create(&calibration, config, &tracker) != K4A_RESULT_SUCCEEDED) return 1;
  k4a_capture_t capture = nullptr;
  while (k4a_playback_get_next_capture(playback, &capture) == K4A_STREAM_RESULT_SUCCEEDED) {
    while (k4abt_tracker_enqueue_capture(tracker, capture, 0) == K4A_WAIT_RESULT_TIMEOUT) print_next(tracker, 100);
    k4a_capture_release(capture);
  }
  k4abt_tracker_shutdown(tracker);
  while (print_next(tracker, K4A_WAIT_INFINITE)) {
  }
  k4abt_tracker_destroy(tracker);
  k4a_playback_close(playback);
}
