#include "io/sensors/realsense_api.h"

#include <fmt/format.h>

#include <vector>

#include "io/sensors/run_time_library.h"

namespace vesalius::rs2 {
namespace {

/// Names of the library: with its developer's package, and without.
std::vector<std::string> names() {
  std::vector<std::string> all{"librealsense2.so"};
  constexpr int kNewest = 99, kOldest = 20;
  for (int minor = kNewest; minor >= kOldest; --minor) all.push_back(fmt::format("librealsense2.so.2.{}", minor));
  return all;
}

Api load() {
  void* library = load_library(
      "VESALIUS_REALSENSE", names(),
      "realsense: librealsense2 is not installed, expected Intel's package librealsense2 (docs/cameras.md)");
  Api api{};
#define VESALIUS_FIND(name) find_function(library, "realsense: librealsense2", "rs2_" #name, api.name)
  VESALIUS_FIND(get_api_version);
  VESALIUS_FIND(get_error_message);
  VESALIUS_FIND(free_error);
  VESALIUS_FIND(create_context);
  VESALIUS_FIND(delete_context);
  VESALIUS_FIND(query_devices);
  VESALIUS_FIND(get_device_count);
  VESALIUS_FIND(delete_device_list);
  VESALIUS_FIND(create_device);
  VESALIUS_FIND(get_device_info);
  VESALIUS_FIND(delete_device);
  VESALIUS_FIND(create_pipeline);
  VESALIUS_FIND(delete_pipeline);
  VESALIUS_FIND(create_config);
  VESALIUS_FIND(delete_config);
  VESALIUS_FIND(config_enable_stream);
  VESALIUS_FIND(config_enable_device);
  VESALIUS_FIND(config_enable_device_from_file);
  VESALIUS_FIND(pipeline_start_with_config);
  VESALIUS_FIND(delete_pipeline_profile);
  VESALIUS_FIND(pipeline_stop);
  VESALIUS_FIND(pipeline_try_wait_for_frames);
  VESALIUS_FIND(pipeline_profile_get_streams);
  VESALIUS_FIND(pipeline_profile_get_device);
  VESALIUS_FIND(query_sensors);
  VESALIUS_FIND(get_sensors_count);
  VESALIUS_FIND(delete_sensor_list);
  VESALIUS_FIND(create_sensor);
  VESALIUS_FIND(delete_sensor);
  VESALIUS_FIND(get_stream_profiles);
  VESALIUS_FIND(get_stream_profiles_count);
  VESALIUS_FIND(get_stream_profile);
  VESALIUS_FIND(delete_stream_profiles_list);
  VESALIUS_FIND(open);
  VESALIUS_FIND(close);
  VESALIUS_FIND(start_queue);
  VESALIUS_FIND(stop);
  VESALIUS_FIND(poll_for_frame);
  VESALIUS_FIND(get_extrinsics);
  VESALIUS_FIND(create_frame_queue);
  VESALIUS_FIND(delete_frame_queue);
  VESALIUS_FIND(embedded_frames_count);
  VESALIUS_FIND(extract_frame);
  VESALIUS_FIND(release_frame);
  VESALIUS_FIND(get_frame_stream_profile);
  VESALIUS_FIND(get_stream_profile_data);
  VESALIUS_FIND(get_video_stream_intrinsics);
  VESALIUS_FIND(get_frame_data);
  VESALIUS_FIND(get_frame_width);
  VESALIUS_FIND(get_frame_height);
  VESALIUS_FIND(get_frame_stride_in_bytes);
  VESALIUS_FIND(get_frame_timestamp);
  VESALIUS_FIND(get_frame_number);
  VESALIUS_FIND(depth_frame_get_units);
#undef VESALIUS_FIND
  return api;
}

}  // namespace

const Api& api() {
  static const Api loaded = load();
  return loaded;
}

const char* text_of(const Failure* failure) { return api().get_error_message(failure); }

void free(Failure* failure) { api().free_error(failure); }

}  // namespace vesalius::rs2
