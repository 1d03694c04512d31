#include "io/sensors/realsense_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include "io/files/copy_rows.h"
#include "io/sensors/realsense_api.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

using rs2::api;

constexpr int kWidth = 640, kHeight = 480, kRate = 30;
constexpr unsigned kAlignPatience_ms = 1000;

/// Receives what a call says and throws it as Error.
class Outcome {
 public:
  explicit Outcome(std::string what) : what_(std::move(what)) {}
  ~Outcome() {
    if (failure_ != nullptr) api().free_error(failure_);
  }
  Outcome(const Outcome&) = delete;
  Outcome& operator=(const Outcome&) = delete;
  rs2::Failure** out() { return &failure_; }
  bool failed() const { return failure_ != nullptr; }
  void expect() const {
    if (!failed()) return;
    std::string reason = api().get_error_message(failure_);
    std::ranges::replace(reason, '\n', ' ');
    throw Error(fmt::format("{}: {}", what_, reason));
  }

 private:
  std::string what_;
  rs2::Failure* failure_ = nullptr;
};

/// Calls a function of the library; its last argument is where it puts an error.
template <class Function, class... Given>
auto call(const std::string& what, Function function, Given... given) {
  Outcome outcome(what);
  if constexpr (std::is_void_v<decltype(function(given..., outcome.out()))>) {
    function(given..., outcome.out());
    outcome.expect();
  } else {
    auto result = function(given..., outcome.out());
    outcome.expect();
    return result;
  }
}

template <class T>
using Owned = std::unique_ptr<T, void (*)(T*)>;

Owned<rs2::Context> make_context() {
  const int version = call("realsense", api().get_api_version);
  return {call("realsense: the library does not start", api().create_context, version), api().delete_context};
}

std::vector<SensorInfo> all_plugged_in(rs2::Context* context) {
  const Owned<rs2::DeviceList> list(call("realsense", api().query_devices, static_cast<const rs2::Context*>(context)),
                                    api().delete_device_list);
  const auto* const devices = static_cast<const rs2::DeviceList*>(list.get());
  std::vector<SensorInfo> infos;
  const int count = call("realsense", api().get_device_count, devices);
  for (int i = 0; i < count; ++i) {
    const Owned<rs2::Device> device(call("realsense", api().create_device, devices, i), api().delete_device);
    const auto* const of = static_cast<const rs2::Device*>(device.get());
    infos.push_back({call("realsense", api().get_device_info, of, rs2::kSerial),
                     call("realsense", api().get_device_info, of, rs2::kName)});
  }
  return infos;
}

class RealsenseSource final : public LiveSource {
 public:
  explicit RealsenseSource(const std::string& id)
      : LiveSource("realsense", id),
        context_(make_context()),
        pipeline_(call(place_, api().create_pipeline, context_.get()), api().delete_pipeline),
        align_(call(place_, api().create_align, rs2::kColour), api().delete_processing_block),
        aligned_(call(place_, api().create_frame_queue, 1), api().delete_frame_queue) {
    const bool is_file = std::filesystem::is_regular_file(id);
    if (!is_file) expect_plugged_in(id);
    start(id, is_file);
    call(place_, api().start_processing_queue, align_.get(), aligned_.get());
  }

  ~RealsenseSource() override {
    Outcome ignored(place_);
    if (profile_) api().pipeline_stop(pipeline_.get(), ignored.out());
  }

  std::optional<Frame> next() override {
    for (;;) {
      Owned<rs2::Frame> all = wait();
      const double arrived_s = now_s();
      if (has_colour_) all = align(std::move(all));
      const Owned<rs2::Frame> depth = stream_of(all.get(), rs2::kDepth);
      if (!depth) continue;
      const rs2::Frame* of = depth.get();
      const auto number = static_cast<std::int64_t>(call(place_, api().get_frame_number, of));
      // Where colour comes late, the library gives the same depth once more.
      if (number == last_number_) continue;
      if (last_number_ >= 0 && number > last_number_ + 1) missed_ += static_cast<int>(number - last_number_ - 1);
      last_number_ = number;
      Frame frame;
      frame.arrived_s = arrived_s;
      frame.time_s = 1e-3 * call(place_, api().get_frame_timestamp, of);
      frame.name = fmt::format("{:.6f}", *frame.time_s);
      frame.camera = camera_of(of);
      frame.depth = depth_of(of);
      if (const Owned<rs2::Frame> colour = has_colour_ ? stream_of(all.get(), rs2::kColour) : none()) {
        frame.colour = colour_of(colour.get(), frame.camera);
      }
      return frame;
    }
  }

 private:
  static Owned<rs2::Frame> none() { return {nullptr, api().release_frame}; }

  /// Returns the next frames of all streams.
  Owned<rs2::Frame> wait() {
    Outcome outcome(place_);
    Owned<rs2::Frame> all(api().pipeline_wait_for_frames(pipeline_.get(), kSensorPatience_ms, outcome.out()),
                          api().release_frame);
    if (outcome.failed() || !all) fail_without_frame();
    return all;
  }

  void expect_plugged_in(const std::string& id) const {
    const std::vector<SensorInfo> cameras = all_plugged_in(context_.get());
    const bool known = std::ranges::find(cameras, id, &SensorInfo::id) != cameras.end();
    if (known || (id.empty() && cameras.size() == 1)) return;
    const std::string ids = sources_of("realsense", cameras);
    throw Error(fmt::format("{}: {}", place_,
                            ids.empty() ? "no camera is plugged in, expected one that `vesalius cameras` lists"
                                        : "expected one of " + ids));
  }

  /// Starts depth and colour; depth alone where there is no colour. Of a file what it has.
  void start(const std::string& id, bool is_file) {
    for (const bool colour : {true, false}) {
      const Owned<rs2::Config> config(call(place_, api().create_config), api().delete_config);
      if (is_file) {
        call(place_, api().config_enable_device_from_file, config.get(), id.c_str());
      } else if (!id.empty()) {
        call(place_, api().config_enable_device, config.get(), id.c_str());
      }
      const int width = is_file ? 0 : kWidth, height = is_file ? 0 : kHeight, rate = is_file ? 0 : kRate;
      call(place_, api().config_enable_stream, config.get(), rs2::kDepth, -1, width, height, rs2::kZ16, rate);
      if (colour)
        call(place_, api().config_enable_stream, config.get(), rs2::kColour, -1, width, height, rs2::kRgb8, rate);
      Outcome outcome(place_ + " cannot be started");
      profile_ = {api().pipeline_start_with_config(pipeline_.get(), config.get(), outcome.out()),
                  api().delete_pipeline_profile};
      has_colour_ = colour;
      if (profile_) break;
      if (!colour) outcome.expect();
    }
    if (!has_colour_) notes_.push_back(place_ + ": depth alone, since it has no colour");
  }

  /// Puts depth onto the grid of colour.
  Owned<rs2::Frame> align(Owned<rs2::Frame> frames) {
    call(place_, api().process_frame, align_.get(), frames.release());  // which takes it over
    return {call(place_, api().wait_for_frame, aligned_.get(), kAlignPatience_ms), api().release_frame};
  }

  /// Returns the frame of one stream out of several; null if there is none.
  Owned<rs2::Frame> stream_of(rs2::Frame* all, int stream) const {
    const int count = call(place_, api().embedded_frames_count, all);
    for (int i = 0; i < count; ++i) {
      Owned<rs2::Frame> one(call(place_, api().extract_frame, all, i), api().release_frame);
      int of = 0, format = 0, index = 0, id = 0, rate = 0;
      const rs2::StreamProfile* profile =
          call(place_, api().get_frame_stream_profile, static_cast<const rs2::Frame*>(one.get()));
      call(place_, api().get_stream_profile_data, profile, &of, &format, &index, &id, &rate);
      if (of == stream) return one;
    }
    return none();
  }

  Camera camera_of(const rs2::Frame* frame) const {
    rs2::Intrinsics lens{};
    call(place_, api().get_video_stream_intrinsics, call(place_, api().get_frame_stream_profile, frame), &lens);
    Camera camera{lens.width, lens.height, lens.fx, lens.fy, lens.ppx, lens.ppy};
    check(camera);
    return camera;
  }

  DepthImage depth_of(const rs2::Frame* frame) const {
    DepthImage depth(call(place_, api().get_frame_width, frame), call(place_, api().get_frame_height, frame));
    const auto stride = static_cast<std::size_t>(call(place_, api().get_frame_stride_in_bytes, frame));
    const auto* data = call(place_, api().get_frame_data, frame);
    copy_rows(data, stride, depth);
    const double to_mm = 1e3 * static_cast<double>(call(place_, api().depth_frame_get_units, frame));
    constexpr double kSame = 1e-6;
    if (std::abs(to_mm - 1.0) < kSame) return depth;
    for (std::uint16_t& z : depth) {
      const double z_mm = to_mm * z;
      z = z_mm < std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(std::lround(z_mm))
                                                           : std::uint16_t{0};
    }
    return depth;
  }

  ColourImage colour_of(const rs2::Frame* frame, const Camera& camera) const {
    if (call(place_, api().get_frame_width, frame) != camera.width ||
        call(place_, api().get_frame_height, frame) != camera.height) {
      return {};
    }
    ColourImage colour(camera.width, camera.height);
    const auto stride = static_cast<std::size_t>(call(place_, api().get_frame_stride_in_bytes, frame));
    const auto* data = call(place_, api().get_frame_data, frame);
    copy_rows(data, stride, colour);
    return colour;
  }

  Owned<rs2::Context> context_;
  Owned<rs2::Pipeline> pipeline_;
  Owned<rs2::Block> align_;
  Owned<rs2::Queue> aligned_;
  Owned<rs2::PipelineProfile> profile_{nullptr, nullptr};
  bool has_colour_ = false;
  std::int64_t last_number_ = -1;
};

}  // namespace

std::vector<SensorInfo> list_realsense() { return all_plugged_in(make_context().get()); }

std::unique_ptr<FrameSource> open_realsense(const std::string& id) { return std::make_unique<RealsenseSource>(id); }

}  // namespace vesalius
