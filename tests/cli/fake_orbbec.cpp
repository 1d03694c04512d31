// A library with the functions of Orbbec's SDK that vesalius uses, and one camera behind them, which is none. Depth is
// 0.5 mm a unit; frame i has in column u and row v the depth 1000 + i + u mm and the colour (i, u / 4, v / 4);
// "registered" depth is 1 mm farther. FAKE_ORBBEC is a list of words: "none" no camera, "grey" no colour, "old" the SDK
// knows no TargetDistortion, "busy" it cannot be started, "lost" it is unplugged after 5 frames and back when it was
// looked for twice.
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace {

struct Failure {
  const char* message;
};
struct Mode {
  int stream, format;
  std::uint32_t width, height, rate;
};
struct Frame {
  Mode mode;
  std::uint64_t index;
  std::vector<std::uint8_t> data;
  std::shared_ptr<Frame> depth, colour;
};
struct Intrinsics {
  float fx, fy, cx, cy;
  std::int16_t width, height;
};
struct Extrinsics {
  float rotation[9], translation[3];
};
struct Distortion {
  float k1, k2, k3, k4, k5, k6, p1, p2;
  std::int32_t model;
};
struct Acceleration {
  float x, y, z;
};
using Callback = void (*)(Frame*, void*);

constexpr int kColour = 2, kDepth = 3, kAccel = 4, kY16 = 8, kRgb = 22;
constexpr std::array<Mode, 2> kDepths{{{kDepth, kY16, 640, 576, 30}, {kDepth, kY16, 640, 480, 30}}};
constexpr std::array<Mode, 3> kColours{
    {{kColour, kRgb, 1280, 720, 30}, {kColour, 5, 640, 480, 30}, {kColour, kRgb, 640, 480, 30}}};
constexpr std::array<Mode, 1> kAccels{{{kAccel, 16, 0, 0, 0}}};
constexpr std::uint64_t kFramesUntilLost = 5;
constexpr int kLooks = 2;

std::uint64_t given = 0;
int looks_until_back = 0;
double align_type = 0.0, distorted = 1.0;
char object;  // what handles without anything behind them point to

bool said(const char* word) {
  const char* words = std::getenv("FAKE_ORBBEC");
  return words != nullptr && std::strstr(words, word) != nullptr;
}

template <class T>
T* fail(Failure** failure, const char* message) {
  *failure = new Failure{message};
  return nullptr;
}

const Mode* modes(int stream) {
  return stream == kDepth ? kDepths.data() : stream == kColour ? kColours.data() : kAccels.data();
}

std::shared_ptr<Frame> picture(const Mode& mode) {
  auto frame = std::make_shared<Frame>(Frame{mode, given, {}, nullptr, nullptr});
  for (std::uint32_t v = 0; v < mode.height; ++v) {
    for (std::uint32_t u = 0; u < mode.width; ++u) {
      const auto depth = static_cast<std::uint16_t>(2 * (1000 + given + u));
      if (mode.stream == kColour) {
        frame->data.insert(frame->data.end(), {std::uint8_t(given), std::uint8_t(u / 4), std::uint8_t(v / 4)});
      } else {
        frame->data.insert(frame->data.end(), {std::uint8_t(depth), std::uint8_t(depth >> 8)});
      }
    }
  }
  return frame;
}

}  // namespace

extern "C" {

const char* ob_error_get_message(const Failure* failure) { return failure->message; }
void ob_delete_error(Failure* failure) { delete failure; }
void ob_set_logger_severity(int, Failure**) {}
char* ob_create_context(Failure**) { return &object; }
void ob_delete_context(char*, Failure**) {}
char* ob_query_device_list(char*, Failure**) {
  if (looks_until_back > 0) --looks_until_back;
  return &object;
}
void ob_delete_device_list(char*, Failure**) {}
std::uint32_t ob_device_list_get_count(const char*, Failure**) { return said("none") || looks_until_back > 0 ? 0 : 1; }
const char* ob_device_list_get_device_name(const char*, std::uint32_t, Failure**) { return "Fake Femto"; }
const char* ob_device_list_get_device_serial_number(const char*, std::uint32_t, Failure**) { return "F1"; }
char* ob_device_list_get_device(const char*, std::uint32_t, Failure**) { return &object; }
void ob_delete_device(char*, Failure**) {}
char* ob_device_get_sensor_list(const char*, Failure**) { return &object; }
std::uint32_t ob_sensor_list_get_count(const char*, Failure**) { return 3; }
int ob_sensor_list_get_sensor_type(const char*, std::uint32_t i, Failure**) {
  return said("grey") ? kDepth : static_cast<int>(i) + kColour;
}
void ob_delete_sensor_list(char*, Failure**) {}
char* ob_device_get_sensor(char*, int, Failure**) { return &object; }
void ob_delete_sensor(char*, Failure**) {}
const Mode* ob_sensor_get_stream_profile_list(const char*, Failure**) { return modes(kAccel); }
void ob_sensor_start(char*, const Mode* mode, Callback callback, void* user, Failure**) {
  callback(new Frame{*mode, 0, {}, nullptr, nullptr}, user);
}
void ob_sensor_stop(char*, Failure**) {}
char* ob_create_pipeline_with_device(const char*, Failure**) { return &object; }
void ob_delete_pipeline(char*, Failure**) {}
const Mode* ob_pipeline_get_stream_profile_list(const char*, int sensor, Failure**) { return modes(sensor); }
void ob_pipeline_enable_frame_sync(char*, Failure** failure) { fail<void>(failure, "this camera cannot"); }
void ob_pipeline_start_with_config(char*, const char*, Failure** failure) {
  if (said("busy")) fail<void>(failure, "uvc device:\nresource busy");
}
void ob_pipeline_stop(char*, Failure**) {}
Frame* ob_pipeline_wait_for_frameset(char*, std::uint32_t, Failure** failure) {
  if (said("lost") && given == kFramesUntilLost) {
    ++given;  // once
    looks_until_back = kLooks;
    return fail<Frame>(failure, "the device was disconnected");
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  auto* all = new Frame{{}, given, {}, picture(kDepths[1]), picture(kColours[2])};
  ++given;
  return all;
}
char* ob_create_config(Failure**) { return &object; }
void ob_delete_config(char*, Failure**) {}
void ob_config_enable_stream_with_stream_profile(char*, const Mode* mode, Failure** failure) {
  if (mode->width != 640 || mode->height != 480) fail<void>(failure, "not the mode that was expected");
}
void ob_config_set_frame_aggregate_output_mode(char*, int, Failure**) {}
std::uint32_t ob_stream_profile_list_get_count(const Mode* list, Failure**) {
  return list->stream == kDepth ? kDepths.size() : list->stream == kColour ? kColours.size() : kAccels.size();
}
const Mode* ob_stream_profile_list_get_profile(const Mode* list, int index, Failure**) { return list + index; }
void ob_delete_stream_profile_list(const Mode*, Failure**) {}
void ob_delete_stream_profile(const Mode*, Failure**) {}
int ob_stream_profile_get_format(const Mode* mode, Failure**) { return mode->format; }
std::uint32_t ob_video_stream_profile_get_width(const Mode* mode, Failure**) { return mode->width; }
std::uint32_t ob_video_stream_profile_get_height(const Mode* mode, Failure**) { return mode->height; }
std::uint32_t ob_video_stream_profile_get_fps(const Mode* mode, Failure**) { return mode->rate; }
Intrinsics ob_video_stream_profile_get_intrinsic(const Mode* mode, Failure**) {
  return {mode->stream == kColour ? 600.F : 500.F, 601.F, 321.F, 242.F, 640, 480};
}
Distortion ob_video_stream_profile_get_distortion(const Mode*, Failure**) {
  constexpr int kRational = 4;
  return {-0.1F, 0.02F, 0.F, 0.05F, 0.F, 0.F, 0.002F, 0.004F, kRational};
}
Extrinsics ob_stream_profile_get_extrinsic_to(const Mode*, Mode*, Failure**) {
  return {{0, 1, 0, -1, 0, 0, 0, 0, 1}, {0, 0, 0}};
}
char* ob_create_filter(const char* name, Failure**) { return std::strcmp(name, "Align") == 0 ? &object : nullptr; }
void ob_delete_filter(char*, Failure**) {}
void ob_filter_set_config_value(char*, const char* name, double value, Failure** failure) {
  const std::string of = name;
  if (of == "AlignType") {
    align_type = value;
  } else if (of == "TargetDistortion" && !said("old")) {
    distorted = value;
  } else {
    fail<void>(failure, "an older version knows no such value");
  }
}
Frame* ob_filter_process(char*, const Frame* all, Failure** failure) {
  if (align_type != kColour || (distorted != 0.0) != said("old")) return fail<Frame>(failure, "not what was expected");
  auto* aligned = new Frame(*all);
  aligned->depth = std::make_shared<Frame>(*all->depth);
  std::vector<std::uint8_t>& data = aligned->depth->data;
  for (std::size_t i = 0; i < data.size(); i += 2) {
    data[i] += 2;
    if (data[i] == 0) ++data[i + 1];
  }
  return aligned;
}
Frame* ob_frameset_get_depth_frame(const Frame* all, Failure**) { return new Frame(*all->depth); }
Frame* ob_frameset_get_color_frame(const Frame* all, Failure**) { return new Frame(*all->colour); }
void ob_delete_frame(Frame* frame, Failure**) { delete frame; }
std::uint8_t* ob_frame_get_data(const Frame* frame, Failure**) { return const_cast<std::uint8_t*>(frame->data.data()); }
std::uint32_t ob_frame_get_data_size(const Frame* frame, Failure**) { return frame->data.size(); }
std::uint64_t ob_frame_get_index(const Frame* frame, Failure**) { return frame->index; }
std::uint64_t ob_frame_get_timestamp_us(const Frame* frame, Failure**) { return 1'000'000 + 33'333 * frame->index; }
std::uint32_t ob_video_frame_get_width(const Frame* frame, Failure**) { return frame->mode.width; }
std::uint32_t ob_video_frame_get_height(const Frame* frame, Failure**) { return frame->mode.height; }
float ob_depth_frame_get_value_scale(const Frame*, Failure**) { return 0.5F; }
Acceleration ob_accel_frame_get_value(const Frame*, Failure**) { return {9.7F, 0.F, 0.F}; }
}
