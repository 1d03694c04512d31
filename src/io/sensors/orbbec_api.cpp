#include "io/sensors/orbbec_api.h"

#include "io/sensors/run_time_library.h"

namespace vesalius::ob {
namespace {

Api load() {
  void* library =
      load_library("VESALIUS_ORBBEC", {"libOrbbecSDK.so.2", "libOrbbecSDK.so"},
                   "orbbec: libOrbbecSDK is not installed, expected version 2 of Orbbec's SDK (docs/cameras.md)");
  Api api{};
#define VESALIUS_FIND(name) find_function(library, "orbbec: libOrbbecSDK", "ob_" #name, api.name)
  VESALIUS_FIND(error_get_message);
  VESALIUS_FIND(delete_error);
  VESALIUS_FIND(set_logger_severity);
  VESALIUS_FIND(create_context);
  VESALIUS_FIND(delete_context);
  VESALIUS_FIND(query_device_list);
  VESALIUS_FIND(delete_device_list);
  VESALIUS_FIND(device_list_get_count);
  VESALIUS_FIND(device_list_get_device_name);
  VESALIUS_FIND(device_list_get_device_serial_number);
  VESALIUS_FIND(device_list_get_device);
  VESALIUS_FIND(delete_device);
  VESALIUS_FIND(device_get_sensor_list);
  VESALIUS_FIND(sensor_list_get_count);
  VESALIUS_FIND(sensor_list_get_sensor_type);
  VESALIUS_FIND(delete_sensor_list);
  VESALIUS_FIND(device_get_sensor);
  VESALIUS_FIND(delete_sensor);
  VESALIUS_FIND(sensor_get_stream_profile_list);
  VESALIUS_FIND(sensor_start);
  VESALIUS_FIND(sensor_stop);
  VESALIUS_FIND(create_pipeline_with_device);
  VESALIUS_FIND(delete_pipeline);
  VESALIUS_FIND(pipeline_get_stream_profile_list);
  VESALIUS_FIND(pipeline_enable_frame_sync);
  VESALIUS_FIND(pipeline_start_with_config);
  VESALIUS_FIND(pipeline_stop);
  VESALIUS_FIND(pipeline_wait_for_frameset);
  VESALIUS_FIND(create_config);
  VESALIUS_FIND(delete_config);
  VESALIUS_FIND(config_enable_stream_with_stream_profile);
  VESALIUS_FIND(config_set_frame_aggregate_output_mode);
  VESALIUS_FIND(stream_profile_list_get_count);
  VESALIUS_FIND(stream_profile_list_get_profile);
  VESALIUS_FIND(delete_stream_profile_list);
  VESALIUS_FIND(delete_stream_profile);
  VESALIUS_FIND(stream_profile_get_format);
  VESALIUS_FIND(video_stream_profile_get_width);
  VESALIUS_FIND(video_stream_profile_get_height);
  VESALIUS_FIND(video_stream_profile_get_fps);
  VESALIUS_FIND(video_stream_profile_get_intrinsic);
  VESALIUS_FIND(video_stream_profile_get_distortion);
  VESALIUS_FIND(stream_profile_get_extrinsic_to);
  VESALIUS_FIND(create_filter);
  VESALIUS_FIND(delete_filter);
  VESALIUS_FIND(filter_set_config_value);
  VESALIUS_FIND(filter_process);
  VESALIUS_FIND(frameset_get_depth_frame);
  VESALIUS_FIND(frameset_get_color_frame);
  VESALIUS_FIND(delete_frame);
  VESALIUS_FIND(frame_get_data);
  VESALIUS_FIND(frame_get_data_size);
  VESALIUS_FIND(frame_get_index);
  VESALIUS_FIND(frame_get_timestamp_us);
  VESALIUS_FIND(video_frame_get_width);
  VESALIUS_FIND(video_frame_get_height);
  VESALIUS_FIND(depth_frame_get_value_scale);
  VESALIUS_FIND(accel_frame_get_value);
#undef VESALIUS_FIND
  return api;
}

}  // namespace

const Api& api() {
  static const Api loaded = load();
  return loaded;
}

const char* text_of(const Failure* failure) { return api().error_get_message(failure); }

void free(Failure* failure) { api().delete_error(failure); }

}  // namespace vesalius::ob
