#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "io/sensors/run_time_library.h"

// What is used of librealsense2's C interface, which has stayed the same since version 2.0. Its headers are in no
// package of Debian, and a library that is loaded while the program runs needs none.
namespace vesalius::rs2 {

struct Failure;  // rs2_error
struct Context;
struct DeviceList;
struct Device;
struct Pipeline;
struct Config;
struct PipelineProfile;
struct Frame;
struct StreamProfile;
struct Queue;  // rs2_frame_queue
struct SensorList;
struct Sensor;
struct StreamProfileList;

/// rs2_intrinsics
struct Intrinsics {
  int width, height;
  float ppx, ppy, fx, fy;  ///< pixels
  int model;
  float coefficients[5];
};

/// rs2_extrinsics
struct Extrinsics {
  float rotation[9];     ///< column by column
  float translation[3];  ///< metres
};

constexpr int kDepth = 1, kColour = 2, kAcceleration = 6;  // rs2_stream
constexpr int kZ16 = 1, kRgb8 = 5, kXyz32f = 16;           // rs2_format
constexpr int kName = 0, kSerial = 1;                      // rs2_camera_info
constexpr int kNoDistortion = 0, kKannalaBrandt = 5;       // rs2_distortion

/// Returns the library's names: with its developer's package, and without.
inline std::vector<std::string> library_names() {
  std::vector<std::string> all{"librealsense2.so"};
  constexpr int kNewest = 99, kOldest = 20;
  for (int minor = kNewest; minor >= kOldest; --minor) all.push_back(fmt::format("librealsense2.so.2.{}", minor));
  return all;
}

/// The functions, by their names without "rs2_".
struct Api : RunTimeLibrary {
  Api()
      : RunTimeLibrary("realsense: librealsense2", "expected Intel's package librealsense2", "VESALIUS_REALSENSE",
                       "rs2_", library_names()) {}

  VESALIUS_FUNCTION(int, get_api_version, Failure**);
  VESALIUS_FUNCTION(const char*, get_error_message, const Failure*);
  VESALIUS_FUNCTION(void, free_error, Failure*);
  VESALIUS_FUNCTION(Context*, create_context, int version, Failure**);
  VESALIUS_FUNCTION(void, delete_context, Context*);
  VESALIUS_FUNCTION(DeviceList*, query_devices, const Context*, Failure**);
  VESALIUS_FUNCTION(int, get_device_count, const DeviceList*, Failure**);
  VESALIUS_FUNCTION(void, delete_device_list, DeviceList*);
  VESALIUS_FUNCTION(Device*, create_device, const DeviceList*, int index, Failure**);
  VESALIUS_FUNCTION(const char*, get_device_info, const Device*, int info, Failure**);
  VESALIUS_FUNCTION(void, delete_device, Device*);
  VESALIUS_FUNCTION(Pipeline*, create_pipeline, Context*, Failure**);
  VESALIUS_FUNCTION(void, delete_pipeline, Pipeline*);
  VESALIUS_FUNCTION(Config*, create_config, Failure**);
  VESALIUS_FUNCTION(void, delete_config, Config*);
  VESALIUS_FUNCTION(void, config_enable_stream, Config*, int stream, int index, int width, int height, int format,
                    int rate, Failure**);
  VESALIUS_FUNCTION(void, config_enable_device, Config*, const char* serial, Failure**);
  VESALIUS_FUNCTION(void, config_enable_device_from_file, Config*, const char* file, Failure**);
  VESALIUS_FUNCTION(PipelineProfile*, pipeline_start_with_config, Pipeline*, Config*, Failure**);
  VESALIUS_FUNCTION(void, delete_pipeline_profile, PipelineProfile*);
  VESALIUS_FUNCTION(void, pipeline_stop, Pipeline*, Failure**);
  VESALIUS_FUNCTION(int, pipeline_try_wait_for_frames, Pipeline*, Frame**, unsigned patience_ms, Failure**);
  VESALIUS_FUNCTION(StreamProfileList*, pipeline_profile_get_streams, PipelineProfile*, Failure**);
  VESALIUS_FUNCTION(Device*, pipeline_profile_get_device, PipelineProfile*, Failure**);
  VESALIUS_FUNCTION(SensorList*, query_sensors, const Device*, Failure**);
  VESALIUS_FUNCTION(int, get_sensors_count, const SensorList*, Failure**);
  VESALIUS_FUNCTION(void, delete_sensor_list, SensorList*);
  VESALIUS_FUNCTION(Sensor*, create_sensor, const SensorList*, int index, Failure**);
  VESALIUS_FUNCTION(void, delete_sensor, Sensor*);
  VESALIUS_FUNCTION(StreamProfileList*, get_stream_profiles, Sensor*, Failure**);
  VESALIUS_FUNCTION(int, get_stream_profiles_count, const StreamProfileList*, Failure**);
  VESALIUS_FUNCTION(const StreamProfile*, get_stream_profile, const StreamProfileList*, int index, Failure**);
  VESALIUS_FUNCTION(void, delete_stream_profiles_list, StreamProfileList*);
  VESALIUS_FUNCTION(void, open, Sensor*, const StreamProfile*, Failure**);
  VESALIUS_FUNCTION(void, close, const Sensor*, Failure**);
  VESALIUS_FUNCTION(void, start_queue, const Sensor*, Queue*, Failure**);
  VESALIUS_FUNCTION(void, stop, const Sensor*, Failure**);
  VESALIUS_FUNCTION(int, poll_for_frame, Queue*, Frame**, Failure**);
  VESALIUS_FUNCTION(void, get_extrinsics, const StreamProfile* from, const StreamProfile* to, Extrinsics*, Failure**);
  VESALIUS_FUNCTION(Queue*, create_frame_queue, int capacity, Failure**);
  VESALIUS_FUNCTION(void, delete_frame_queue, Queue*);
  VESALIUS_FUNCTION(int, embedded_frames_count, Frame*, Failure**);
  VESALIUS_FUNCTION(Frame*, extract_frame, Frame*, int index, Failure**);
  VESALIUS_FUNCTION(void, release_frame, Frame*);
  VESALIUS_FUNCTION(const StreamProfile*, get_frame_stream_profile, const Frame*, Failure**);
  VESALIUS_FUNCTION(void, get_stream_profile_data, const StreamProfile*, int* stream, int* format, int* index, int* id,
                    int* rate, Failure**);
  VESALIUS_FUNCTION(void, get_video_stream_intrinsics, const StreamProfile*, Intrinsics*, Failure**);
  VESALIUS_FUNCTION(const void*, get_frame_data, const Frame*, Failure**);
  VESALIUS_FUNCTION(int, get_frame_width, const Frame*, Failure**);
  VESALIUS_FUNCTION(int, get_frame_height, const Frame*, Failure**);
  VESALIUS_FUNCTION(int, get_frame_stride_in_bytes, const Frame*, Failure**);
  VESALIUS_FUNCTION(double, get_frame_timestamp, const Frame*, Failure**);
  VESALIUS_FUNCTION(unsigned long long, get_frame_number, const Frame*, Failure**);
  VESALIUS_FUNCTION(float, depth_frame_get_units, const Frame*, Failure**);
};

/// Returns the functions of the library. Throws Error saying how to get it where it is not installed or lacks one.
inline const Api& api() {
  static const Api loaded;
  return loaded;
}

// For Outcome.
inline const char* text_of(const Failure* failure) { return api().get_error_message(failure); }
inline void free(Failure* failure) { api().free_error(failure); }

}  // namespace vesalius::rs2
