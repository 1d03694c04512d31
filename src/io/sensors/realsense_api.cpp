#include "io/sensors/realsense_api.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <vector>

#include "vesalius/base/error.h"

namespace vesalius::rs2 {
namespace {

/// Names of the library: with its developer's package, and without.
std::vector<std::string> names() {
  if (const char* given = std::getenv("VESALIUS_REALSENSE")) return {given};
  std::vector<std::string> all{"librealsense2.so"};
  constexpr int kNewest = 99, kOldest = 20;
  for (int minor = kNewest; minor >= kOldest; --minor) all.push_back(fmt::format("librealsense2.so.2.{}", minor));
  return all;
}

void* open_library() {
  for (const std::string& name : names()) {
    if (void* opened = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) return opened;
  }
  throw Error("realsense: librealsense2 is not installed, expected Intel's package librealsense2 (docs/cameras.md)");
}

template <class Function>
void find(void* library, const char* name, Function& function) {
  void* found = ::dlsym(library, name);
  if (found == nullptr) throw Error(fmt::format("realsense: the library has no {}", name));
  function = reinterpret_cast<Function>(found);
}

Api load() {
  void* library = open_library();  // stays open: others of its threads may run until the end
  Api api{};
#define VESALIUS_FIND(name) find(library, "rs2_" #name, api.name)
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
  VESALIUS_FIND(pipeline_wait_for_frames);
  VESALIUS_FIND(create_align);
  VESALIUS_FIND(delete_processing_block);
  VESALIUS_FIND(create_frame_queue);
  VESALIUS_FIND(delete_frame_queue);
  VESALIUS_FIND(start_processing_queue);
  VESALIUS_FIND(process_frame);
  VESALIUS_FIND(wait_for_frame);
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

}  // namespace vesalius::rs2
