#pragma once

#include <cstdint>

#include "io/sensors/run_time_library.h"

// What is used of the C interface of Orbbec's SDK, version 2. Its headers are in no package of Debian, and a library
// that is loaded while the program runs needs none.
namespace vesalius::ob {

struct Failure;  // ob_error
struct Context;
struct DeviceList;
struct Device;
struct Sensor;
struct SensorList;
struct Pipeline;
struct Config;
struct StreamProfile;
struct StreamProfileList;
struct Filter;
struct Frame;

#pragma pack(push, 1)  // as the SDK has them

/// ob_camera_intrinsic
struct Intrinsics {
  float fx, fy, cx, cy;  ///< pixels
  std::int16_t width, height;
};

/// ob_camera_distortion
struct Distortion {
  float k1, k2, k3, k4, k5, k6, p1, p2;
  std::int32_t model;
};

/// ob_extrinsic
struct Extrinsics {
  float rotation[9];     ///< row by row
  float translation[3];  ///< millimetres
};

/// ob_accel_value
struct Acceleration {
  float x, y, z;  ///< m/s2
};

#pragma pack(pop)

/// ob_frame_callback; whoever is called deletes the frame.
using FrameCallback = void (*)(Frame*, void* user);

constexpr int kSilent = 5;                                           // ob_log_severity
constexpr int kColour = 2, kDepth = 3, kAccel = 4;                   // ob_sensor_type and ob_stream_type
constexpr int kY16 = 8, kRgb = 22, kZ16 = 28;                        // ob_format
constexpr int kAllStreams = 0;                                       // ob_frame_aggregate_output_mode
constexpr int kNoDistortion = 0, kRational = 4, kKannalaBrandt = 5;  // ob_camera_distortion_model

/// The functions, by their names without "ob_".
struct Api : RunTimeLibrary {
  Api()
      : RunTimeLibrary("orbbec: libOrbbecSDK", "expected version 2 of Orbbec's SDK", "VESALIUS_ORBBEC", "ob_",
                       {"libOrbbecSDK.so.2", "libOrbbecSDK.so"}) {}

  VESALIUS_FUNCTION(const char*, error_get_message, const Failure*);
  VESALIUS_FUNCTION(void, delete_error, Failure*);
  VESALIUS_FUNCTION(void, set_logger_severity, int severity, Failure**);
  VESALIUS_FUNCTION(Context*, create_context, Failure**);
  VESALIUS_FUNCTION(void, delete_context, Context*, Failure**);
  VESALIUS_FUNCTION(DeviceList*, query_device_list, Context*, Failure**);
  VESALIUS_FUNCTION(void, delete_device_list, DeviceList*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, device_list_get_count, const DeviceList*, Failure**);
  VESALIUS_FUNCTION(const char*, device_list_get_device_name, const DeviceList*, std::uint32_t index, Failure**);
  VESALIUS_FUNCTION(const char*, device_list_get_device_serial_number, const DeviceList*, std::uint32_t index,
                    Failure**);
  VESALIUS_FUNCTION(Device*, device_list_get_device, const DeviceList*, std::uint32_t index, Failure**);
  VESALIUS_FUNCTION(void, delete_device, Device*, Failure**);
  VESALIUS_FUNCTION(SensorList*, device_get_sensor_list, const Device*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, sensor_list_get_count, const SensorList*, Failure**);
  VESALIUS_FUNCTION(int, sensor_list_get_sensor_type, const SensorList*, std::uint32_t index, Failure**);
  VESALIUS_FUNCTION(void, delete_sensor_list, SensorList*, Failure**);
  VESALIUS_FUNCTION(Sensor*, device_get_sensor, Device*, int type, Failure**);
  VESALIUS_FUNCTION(void, delete_sensor, Sensor*, Failure**);
  VESALIUS_FUNCTION(StreamProfileList*, sensor_get_stream_profile_list, const Sensor*, Failure**);
  VESALIUS_FUNCTION(void, sensor_start, Sensor*, const StreamProfile*, FrameCallback, void* user, Failure**);
  VESALIUS_FUNCTION(void, sensor_stop, Sensor*, Failure**);
  VESALIUS_FUNCTION(Pipeline*, create_pipeline_with_device, const Device*, Failure**);
  VESALIUS_FUNCTION(void, delete_pipeline, Pipeline*, Failure**);
  VESALIUS_FUNCTION(StreamProfileList*, pipeline_get_stream_profile_list, const Pipeline*, int sensor, Failure**);
  VESALIUS_FUNCTION(void, pipeline_enable_frame_sync, Pipeline*, Failure**);
  VESALIUS_FUNCTION(void, pipeline_start_with_config, Pipeline*, const Config*, Failure**);
  VESALIUS_FUNCTION(void, pipeline_stop, Pipeline*, Failure**);
  VESALIUS_FUNCTION(Frame*, pipeline_wait_for_frameset, Pipeline*, std::uint32_t patience_ms, Failure**);
  VESALIUS_FUNCTION(Config*, create_config, Failure**);
  VESALIUS_FUNCTION(void, delete_config, Config*, Failure**);
  VESALIUS_FUNCTION(void, config_enable_stream_with_stream_profile, Config*, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(void, config_set_frame_aggregate_output_mode, Config*, int mode, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, stream_profile_list_get_count, const StreamProfileList*, Failure**);
  VESALIUS_FUNCTION(StreamProfile*, stream_profile_list_get_profile, const StreamProfileList*, int index, Failure**);
  VESALIUS_FUNCTION(void, delete_stream_profile_list, StreamProfileList*, Failure**);
  VESALIUS_FUNCTION(void, delete_stream_profile, StreamProfile*, Failure**);
  VESALIUS_FUNCTION(int, stream_profile_get_format, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, video_stream_profile_get_width, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, video_stream_profile_get_height, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, video_stream_profile_get_fps, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(Intrinsics, video_stream_profile_get_intrinsic, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(Distortion, video_stream_profile_get_distortion, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(Extrinsics, stream_profile_get_extrinsic_to, const StreamProfile* from, StreamProfile* to,
                    Failure**);
  VESALIUS_FUNCTION(Filter*, create_filter, const char* name, Failure**);
  VESALIUS_FUNCTION(void, delete_filter, Filter*, Failure**);
  VESALIUS_FUNCTION(void, filter_set_config_value, Filter*, const char* name, double value, Failure**);
  VESALIUS_FUNCTION(Frame*, filter_process, Filter*, const Frame*, Failure**);
  VESALIUS_FUNCTION(Frame*, frameset_get_depth_frame, const Frame*, Failure**);
  VESALIUS_FUNCTION(Frame*, frameset_get_color_frame, const Frame*, Failure**);
  VESALIUS_FUNCTION(void, delete_frame, Frame*, Failure**);
  VESALIUS_FUNCTION(std::uint8_t*, frame_get_data, const Frame*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, frame_get_data_size, const Frame*, Failure**);
  VESALIUS_FUNCTION(std::uint64_t, frame_get_index, const Frame*, Failure**);
  VESALIUS_FUNCTION(std::uint64_t, frame_get_timestamp_us, const Frame*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, video_frame_get_width, const Frame*, Failure**);
  VESALIUS_FUNCTION(std::uint32_t, video_frame_get_height, const Frame*, Failure**);
  VESALIUS_FUNCTION(float, depth_frame_get_value_scale, const Frame*, Failure**);
  VESALIUS_FUNCTION(Acceleration, accel_frame_get_value, const Frame*, Failure**);
};

/// Returns the functions of the library. Throws Error saying how to get it where it is not installed or lacks one.
inline const Api& api() {
  static const Api loaded;
  return loaded;
}

// For Outcome.
inline const char* text_of(const Failure* failure) { return api().error_get_message(failure); }
inline void free(Failure* failure) { api().delete_error(failure); }

}  // namespace vesalius::ob
