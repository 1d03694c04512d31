#include <k4abt.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "k4abt/body_frame.h"
#include "k4abt/body_tracker.h"
#include "k4abt/guard.h"
#include "k4abt/k4a_library.h"
#include "standin/handle_registry.h"
#include "standin/shared_detector.h"
#include "vesalius/error.h"

namespace vesalius::k4abt {
namespace {

/// The registries are never destroyed: programs may release what they have at their very end.
auto& trackers() {
  static auto& registry = *new standin::HandleRegistry<k4abt_tracker_t, BodyTracker>("tracker");
  return registry;
}
auto& frames() {
  static auto& registry = *new standin::HandleRegistry<k4abt_frame_t, const BodyFrame>("frame");
  return registry;
}

/// No thread may run on while the libraries that it uses are taken down.
void end_at_exit() {
  static const bool registered = [] {
    return std::atexit([] {
      for (const auto& tracker : trackers().clear()) tracker->end();
    });
  }() == 0;
  (void)registered;
}

template <class T>
T& need(T* pointer, const char* name) {
  if (pointer == nullptr) throw UsageError(std::string(name) + " is NULL");
  return *pointer;
}

/// Returns the model of a path that a program configures: null and what only Microsoft's library reads (.onnx) stand
/// for the usual one.
std::string model_of(const char* model_path) {
  std::string asked = model_path != nullptr ? model_path : "";
  const bool is_theirs = asked.ends_with(".onnx") || asked.ends_with(".ONNX");
  if (is_theirs) kGuard.say_once("the model " + asked + " is not of vesalius; its own is used");
  if (!asked.empty() && !is_theirs) return asked;
  return standin::usual_model(reinterpret_cast<const void*>(&k4abt_tracker_create), VESALIUS_MODELS_FROM_K4ABT);
}

/// Returns what a program gives, which need not be one of the enumeration's.
template <class Enum>
int value_of(const Enum& given) {
  int value = 0;
  std::memcpy(&value, &given, sizeof value);
  return value;
}

/// Returns by how many quarters pictures of a camera are turned clockwise to be upright, which is mounted so.
std::optional<int> quarter_turns(int orientation) {
  switch (orientation) {
    case K4ABT_SENSOR_ORIENTATION_DEFAULT:
      return std::nullopt;
    // Turned clockwise for somebody in front of it, a camera sees heads at its right.
    case K4ABT_SENSOR_ORIENTATION_CLOCKWISE90:
      return 3;
    case K4ABT_SENSOR_ORIENTATION_COUNTERCLOCKWISE90:
      return 1;
    case K4ABT_SENSOR_ORIENTATION_FLIP180:
      return 2;
  }
  throw UsageError("sensor_orientation is " + std::to_string(orientation) + ", expected 0 to 3");
}

const k4abt_body_t& body_of(const BodyFrame& frame, std::uint32_t index) {
  if (index < frame.bodies().size()) return frame.bodies()[index];
  throw UsageError("body " + std::to_string(index) + " is not there, expected one of " +
                   std::to_string(frame.bodies().size()) + " from 0");
}

}  // namespace
}  // namespace vesalius::k4abt

using namespace vesalius;
using namespace vesalius::k4abt;

k4a_result_t k4abt_tracker_create(const k4a_calibration_t* sensor_calibration, k4abt_tracker_configuration_t config,
                                  k4abt_tracker_t* tracker_handle) {
  return kGuard.run(__func__, K4A_RESULT_FAILED, [&] {
    need(tracker_handle, "tracker_handle") = nullptr;
    CaptureReader reader(need(sensor_calibration, "sensor_calibration"),
                         quarter_turns(value_of(config.sensor_orientation)));
    (void)k4a();
    if (value_of(config.processing_mode) != K4ABT_TRACKER_PROCESSING_MODE_CPU) {
      kGuard.say_once("people are found on the processor; processing_mode and gpu_device_id are ignored");
    }
    auto tracker =
        std::make_shared<BodyTracker>(standin::shared_detector(model_of(config.model_path)), std::move(reader));
    end_at_exit();
    *tracker_handle = trackers().add(std::move(tracker));
    return K4A_RESULT_SUCCEEDED;
  });
}

void k4abt_tracker_destroy(k4abt_tracker_t tracker_handle) {
  kGuard.run(__func__, [&] { trackers().release(tracker_handle)->end(); });
}

void k4abt_tracker_set_temporal_smoothing(k4abt_tracker_t tracker_handle, float smoothing_factor) {
  kGuard.run(__func__, [&] {
    const auto tracker = trackers().get(tracker_handle);
    if (std::isnan(smoothing_factor)) throw UsageError("smoothing_factor is no number, expected 0 to 1");
    tracker->set_smoothing(std::clamp(smoothing_factor, 0.F, 1.F));
  });
}

k4a_wait_result_t k4abt_tracker_enqueue_capture(k4abt_tracker_t tracker_handle, k4a_capture_t sensor_capture_handle,
                                                int32_t timeout_in_ms) {
  return kGuard.run(__func__, K4A_WAIT_RESULT_FAILED, [&] {
    const auto tracker = trackers().get(tracker_handle);
    return tracker->enqueue(&need(sensor_capture_handle, "sensor_capture_handle"), timeout_in_ms);
  });
}

k4a_wait_result_t k4abt_tracker_pop_result(k4abt_tracker_t tracker_handle, k4abt_frame_t* body_frame_handle,
                                           int32_t timeout_in_ms) {
  return kGuard.run(__func__, K4A_WAIT_RESULT_FAILED, [&] {
    need(body_frame_handle, "body_frame_handle") = nullptr;
    std::shared_ptr<const BodyFrame> frame;
    const k4a_wait_result_t result = trackers().get(tracker_handle)->pop(frame, timeout_in_ms);
    if (frame) *body_frame_handle = frames().add(std::move(frame));
    return result;
  });
}

void k4abt_tracker_shutdown(k4abt_tracker_t tracker_handle) {
  kGuard.run(__func__, [&] { trackers().get(tracker_handle)->shut_down(); });
}

void k4abt_frame_release(k4abt_frame_t body_frame_handle) {
  kGuard.run(__func__, [&] { frames().release(body_frame_handle); });
}

void k4abt_frame_reference(k4abt_frame_t body_frame_handle) {
  kGuard.run(__func__, [&] { frames().reference(body_frame_handle); });
}

uint32_t k4abt_frame_get_num_bodies(k4abt_frame_t body_frame_handle) {
  return kGuard.run(__func__, uint32_t{0},
                    [&] { return static_cast<uint32_t>(frames().get(body_frame_handle)->bodies().size()); });
}

k4a_result_t k4abt_frame_get_body_skeleton(k4abt_frame_t body_frame_handle, uint32_t index,
                                           k4abt_skeleton_t* skeleton) {
  return kGuard.run(__func__, K4A_RESULT_FAILED, [&] {
    const auto frame = frames().get(body_frame_handle);
    need(skeleton, "skeleton") = body_of(*frame, index).skeleton;
    return K4A_RESULT_SUCCEEDED;
  });
}

uint32_t k4abt_frame_get_body_id(k4abt_frame_t body_frame_handle, uint32_t index) {
  return kGuard.run(__func__, uint32_t{K4ABT_INVALID_BODY_ID}, [&] {
    const auto frame = frames().get(body_frame_handle);
    return body_of(*frame, index).id;
  });
}

uint64_t k4abt_frame_get_device_timestamp_usec(k4abt_frame_t body_frame_handle) {
  return kGuard.run(__func__, uint64_t{0}, [&] { return frames().get(body_frame_handle)->device_usec(); });
}

uint64_t k4abt_frame_get_system_timestamp_nsec(k4abt_frame_t body_frame_handle) {
  return kGuard.run(__func__, uint64_t{0}, [&] { return frames().get(body_frame_handle)->system_nsec(); });
}

uint64_t k4abt_frame_get_timestamp_usec(k4abt_frame_t body_frame_handle) {
  return k4abt_frame_get_device_timestamp_usec(body_frame_handle);
}

k4a_image_t k4abt_frame_get_body_index_map(k4abt_frame_t body_frame_handle) {
  return kGuard.run(__func__, k4a_image_t{}, [&] {
    const auto frame = frames().get(body_frame_handle);
    const k4a_image_t picture = frame->index_map();
    k4a().image_reference(picture);
    return picture;
  });
}

k4a_capture_t k4abt_frame_get_capture(k4abt_frame_t body_frame_handle) {
  return kGuard.run(__func__, k4a_capture_t{}, [&] {
    const auto frame = frames().get(body_frame_handle);
    k4a().capture_reference(frame->capture());
    return frame->capture();
  });
}
