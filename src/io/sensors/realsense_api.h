#pragma once

#include <string>

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

/// The functions, by their names without "rs2_".
struct Api {
  int (*get_api_version)(Failure**);
  const char* (*get_error_message)(const Failure*);
  void (*free_error)(Failure*);
  Context* (*create_context)(int version, Failure**);
  void (*delete_context)(Context*);
  DeviceList* (*query_devices)(const Context*, Failure**);
  int (*get_device_count)(const DeviceList*, Failure**);
  void (*delete_device_list)(DeviceList*);
  Device* (*create_device)(const DeviceList*, int index, Failure**);
  const char* (*get_device_info)(const Device*, int info, Failure**);
  void (*delete_device)(Device*);
  Pipeline* (*create_pipeline)(Context*, Failure**);
  void (*delete_pipeline)(Pipeline*);
  Config* (*create_config)(Failure**);
  void (*delete_config)(Config*);
  void (*config_enable_stream)(Config*, int stream, int index, int width, int height, int format, int rate, Failure**);
  void (*config_enable_device)(Config*, const char* serial, Failure**);
  void (*config_enable_device_from_file)(Config*, const char* file, Failure**);
  PipelineProfile* (*pipeline_start_with_config)(Pipeline*, Config*, Failure**);
  void (*delete_pipeline_profile)(PipelineProfile*);
  void (*pipeline_stop)(Pipeline*, Failure**);
  int (*pipeline_try_wait_for_frames)(Pipeline*, Frame**, unsigned patience_ms, Failure**);
  StreamProfileList* (*pipeline_profile_get_streams)(PipelineProfile*, Failure**);
  Device* (*pipeline_profile_get_device)(PipelineProfile*, Failure**);
  SensorList* (*query_sensors)(const Device*, Failure**);
  int (*get_sensors_count)(const SensorList*, Failure**);
  void (*delete_sensor_list)(SensorList*);
  Sensor* (*create_sensor)(const SensorList*, int index, Failure**);
  void (*delete_sensor)(Sensor*);
  StreamProfileList* (*get_stream_profiles)(Sensor*, Failure**);
  int (*get_stream_profiles_count)(const StreamProfileList*, Failure**);
  const StreamProfile* (*get_stream_profile)(const StreamProfileList*, int index, Failure**);
  void (*delete_stream_profiles_list)(StreamProfileList*);
  void (*open)(Sensor*, const StreamProfile*, Failure**);
  void (*close)(const Sensor*, Failure**);
  void (*start_queue)(const Sensor*, Queue*, Failure**);
  void (*stop)(const Sensor*, Failure**);
  int (*poll_for_frame)(Queue*, Frame**, Failure**);
  void (*get_extrinsics)(const StreamProfile* from, const StreamProfile* to, Extrinsics*, Failure**);
  Queue* (*create_frame_queue)(int capacity, Failure**);
  void (*delete_frame_queue)(Queue*);
  int (*embedded_frames_count)(Frame*, Failure**);
  Frame* (*extract_frame)(Frame*, int index, Failure**);
  void (*release_frame)(Frame*);
  const StreamProfile* (*get_frame_stream_profile)(const Frame*, Failure**);
  void (*get_stream_profile_data)(const StreamProfile*, int* stream, int* format, int* index, int* id, int* rate,
                                  Failure**);
  void (*get_video_stream_intrinsics)(const StreamProfile*, Intrinsics*, Failure**);
  const void* (*get_frame_data)(const Frame*, Failure**);
  int (*get_frame_width)(const Frame*, Failure**);
  int (*get_frame_height)(const Frame*, Failure**);
  int (*get_frame_stride_in_bytes)(const Frame*, Failure**);
  double (*get_frame_timestamp)(const Frame*, Failure**);
  unsigned long long (*get_frame_number)(const Frame*, Failure**);
  float (*depth_frame_get_units)(const Frame*, Failure**);
};

/// Returns the functions of the library. Throws Error saying how to get it where it is not installed or lacks one.
const Api& api();

// For Outcome.
const char* text_of(const Failure* failure);
void free(Failure* failure);

}  // namespace vesalius::rs2
