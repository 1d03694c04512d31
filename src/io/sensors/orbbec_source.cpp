#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "io/files/image_bytes.h"
#include "io/lens/lens.h"
#include "io/sensors/live_source.h"
#include "io/sensors/orbbec_api.h"
#include "io/sensors/run_time_library.h"
#include "io/sensors/sensor_drivers.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using ob::api;

/// Of ob_camera_distortion_model, in its order.
constexpr std::array<std::string_view, 6> kOrbbecLenses{
    "none",          "modified Brown-Conrady", "inverse Brown-Conrady",
    "Brown-Conrady", "rational polynomial",    "Kannala-Brandt4"};

/// Deletes an object of the library; that it cannot is of no interest.
template <class T>
struct Delete {
  void (*function)(T*, ob::Failure**) = nullptr;
  void operator()(T* object) const {
    Outcome<ob::Failure> ignored("orbbec");
    function(object, ignored.out());
  }
};
template <class T>
using Held = std::unique_ptr<T, Delete<T>>;

template <class T>
Held<T> hold(T* object, void (*function)(T*, ob::Failure**)) {
  return {object, {function}};
}

Held<ob::Context> make_context() {
  // Otherwise it writes a folder of logs where the program was started.
  call("orbbec", api().set_logger_severity, ob::kSilent);
  return hold(call("orbbec: the library does not start", api().create_context), api().delete_context);
}

Held<ob::DeviceList> devices_of(ob::Context* context) {
  return hold(call("orbbec", api().query_device_list, context), api().delete_device_list);
}

std::vector<SensorInfo> infos_of(const ob::DeviceList* devices) {
  std::vector<SensorInfo> infos;
  const std::uint32_t count = call("orbbec", api().device_list_get_count, devices);
  for (std::uint32_t i = 0; i < count; ++i) {
    const char* serial = call("orbbec", api().device_list_get_device_serial_number, devices, i);
    const char* name = call("orbbec", api().device_list_get_device_name, devices, i);
    infos.push_back({serial == nullptr ? "" : serial, name == nullptr ? "" : name});
  }
  return infos;
}

/// What a stream can be: one row of a camera's list.
struct Mode {
  Held<ob::StreamProfile> profile;
  std::uint32_t width = 0, height = 0, rate = 0;
  int format = 0;

  bool is_usual() const { return width == kCameraWidth && height == kCameraHeight && rate == kCameraRate; }
};

/// Returns the modes of a list, which it takes over; that of the camera's choice is the first.
std::vector<Mode> modes_of(const Held<ob::StreamProfileList>& list, const std::string& place) {
  std::vector<Mode> modes;
  const auto* const all = static_cast<const ob::StreamProfileList*>(list.get());
  const std::uint32_t count = call(place, api().stream_profile_list_get_count, all);
  for (std::uint32_t i = 0; i < count; ++i) {
    Mode mode;
    mode.profile = hold(call(place, api().stream_profile_list_get_profile, all, int(i)), api().delete_stream_profile);
    const auto* const one = static_cast<const ob::StreamProfile*>(mode.profile.get());
    mode.format = call(place, api().stream_profile_get_format, one);
    mode.width = call(place, api().video_stream_profile_get_width, one);
    mode.height = call(place, api().video_stream_profile_get_height, one);
    mode.rate = call(place, api().video_stream_profile_get_fps, one);
    modes.push_back(std::move(mode));
  }
  return modes;
}

/// Depth that is packed is unpacked by the SDK, so any format will do.
Mode* choose_depth_mode(std::vector<Mode>& modes) {
  for (Mode& mode : modes) {
    if (mode.is_usual() && (mode.format == ob::kY16 || mode.format == ob::kZ16)) return &mode;
  }
  for (Mode& mode : modes) {
    if (mode.is_usual()) return &mode;
  }
  return modes.empty() ? nullptr : &modes.front();
}

/// Returns the mode of colour whose shape is most like depth's, so that little of depth lies outside; of these the
/// smallest that has as many rows; null if there is none.
Mode* choose_colour(std::vector<Mode>& modes, const Mode& depth) {
  const auto shape = [](const Mode& mode) { return std::log(double(mode.width) / double(mode.height)); };
  Mode* best = nullptr;
  const auto rank = [&](const Mode& mode) {
    const double unlike = std::round(100.0 * std::abs(shape(mode) - shape(depth)));
    const std::uint32_t size = mode.width * mode.height;
    return std::tuple(mode.rate != depth.rate, unlike, mode.height < kCameraHeight, size);
  };
  for (Mode& mode : modes) {
    if (mode.format != ob::kRgb || mode.width == 0 || mode.height == 0) continue;
    if (best == nullptr || rank(mode) < rank(*best)) best = &mode;
  }
  return best;
}

/// Returns the coefficients of a lens in the order of `make_lens`, without those that its model does not have.
std::vector<double> coefficients_of(const ob::Distortion& lens) {
  if (lens.model == ob::kNoDistortion) return {};
  if (lens.model == ob::kKannalaBrandt) return {lens.k1, lens.k2, lens.k3, lens.k4};
  if (lens.model != ob::kRational) return {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
  return {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3, lens.k4, lens.k5, lens.k6};
}

/// The sensor of acceleration of a camera, apart from the pictures, which must not wait for it. A camera without one,
/// or whose one does not start, has no `up`.
class OrbbecAccelerometer {
 public:
  OrbbecAccelerometer(ob::Device* device, const std::string& place) : place_(place) {
    sensor_ = hold(call(place, api().device_get_sensor, device, ob::kAccel), api().delete_sensor);
    const auto list =
        hold(call(place, api().sensor_get_stream_profile_list, static_cast<const ob::Sensor*>(sensor_.get())),
             api().delete_stream_profile_list);
    profile_ = hold(
        call(place, api().stream_profile_list_get_profile, static_cast<const ob::StreamProfileList*>(list.get()), 0),
        api().delete_stream_profile);
    call(place, api().sensor_start, sensor_.get(), static_cast<const ob::StreamProfile*>(profile_.get()), take,
         static_cast<void*>(this));
  }
  ~OrbbecAccelerometer() {
    Outcome<ob::Failure> ignored(place_);
    api().sensor_stop(sensor_.get(), ignored.out());
  }
  OrbbecAccelerometer(const OrbbecAccelerometer&) = delete;
  OrbbecAccelerometer& operator=(const OrbbecAccelerometer&) = delete;

  /// Returns the direction away from the ground in the optical frame of a stream, by the newest measurement.
  std::optional<Eigen::Vector3f> up(ob::StreamProfile* in) const {
    Eigen::Vector3f measured;
    {
      const std::scoped_lock lock(mutex_);
      measured = measured_;
    }
    Outcome<ob::Failure> unknown(place_);
    const ob::Extrinsics to = api().stream_profile_get_extrinsic_to(profile_.get(), in, unknown.out());
    if (unknown.failed()) return std::nullopt;
    Eigen::Matrix3f rotation;
    for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = to.rotation[i];
    return up_of(rotation * measured);
  }

 private:
  static void take(ob::Frame* frame, void* user) {
    const auto held = hold(frame, api().delete_frame);
    auto* const self = static_cast<OrbbecAccelerometer*>(user);
    Outcome<ob::Failure> outcome(self->place_);
    const ob::Acceleration value = api().accel_frame_get_value(frame, outcome.out());
    if (outcome.failed()) return;
    const std::scoped_lock lock(self->mutex_);
    self->measured_ = {value.x, value.y, value.z};
  }

  std::string place_;
  Held<ob::Sensor> sensor_;
  Held<ob::StreamProfile> profile_;
  mutable std::mutex mutex_;
  Eigen::Vector3f measured_ = Eigen::Vector3f::Zero();  ///< m/s2
};

class OrbbecSource final : public LiveSource {
 public:
  explicit OrbbecSource(const std::string& id) : LiveSource("orbbec", id), context_(make_context()) {
    open(id);
    choose_modes();
    start();
    if (has_sensor(ob::kAccel)) start_acceleration();
  }

  ~OrbbecSource() override {
    acceleration_.reset();
    Outcome<ob::Failure> ignored(place_);
    api().pipeline_stop(pipeline_.get(), ignored.out());
  }

  std::optional<Frame> next() override {
    Pictures pictures;
    const auto has_frame = [&](std::chrono::milliseconds patience) {
      pictures = wait(patience);
      return pictures.depth != nullptr;
    };
    if (!wait_for_frame(has_frame)) return std::nullopt;
    const auto index = static_cast<std::int64_t>(call(place_, api().frame_get_index, pictures.measured()));
    if (last_index_ >= 0 && index > last_index_ + 1) missed_ += int(index - last_index_ - 1);
    last_index_ = index;
    const auto time_us = call(place_, api().frame_get_timestamp_us, pictures.measured());
    Frame frame = arrived(double(time_us) / kMicroseconds);
    frame.camera = camera_;
    frame.depth = DepthImage(camera_.width, camera_.height);
    copy(pictures.depth.get(), frame.depth, "depth");
    to_millimetres(frame.depth, double(call(place_, api().depth_frame_get_value_scale, pictures.measured())));
    if (rectification_ && !is_registered_without_lens_) frame.depth = rectification_->depth(frame.depth);
    if (pictures.colour) {
      frame.colour = ColourImage(camera_.width, camera_.height);
      copy(pictures.colour.get(), frame.colour, "colour");
      if (rectification_) frame.colour = rectification_->colour(frame.colour);
    }
    if (acceleration_) frame.up = acceleration_->up(grid_.get());
    return frame;
  }

 private:
  struct Pictures {
    Held<ob::Frame> original;  ///< depth as the camera took it
    Held<ob::Frame> depth, colour;

    const ob::Frame* measured() const { return original.get(); }
  };

  void open(const std::string& id) {
    const auto devices = devices_of(context_.get());
    const std::vector<SensorInfo> infos = infos_of(devices.get());
    expect_plugged_in("orbbec", infos, id);
    const auto one = id.empty() ? infos.begin() : std::ranges::find(infos, id, &SensorInfo::id);
    Outcome<ob::Failure> outcome(place_);
    device_ = hold(
        api().device_list_get_device(devices.get(), static_cast<std::uint32_t>(one - infos.begin()), outcome.out()),
        api().delete_device);
    if (!device_) fail_to_open(place_, outcome.reason());
    pipeline_ = hold(call(place_, api().create_pipeline_with_device, static_cast<const ob::Device*>(device_.get())),
                     api().delete_pipeline);
  }

  bool has_sensor(int type) const {
    const auto list = hold(call(place_, api().device_get_sensor_list, static_cast<const ob::Device*>(device_.get())),
                           api().delete_sensor_list);
    const auto* const all = static_cast<const ob::SensorList*>(list.get());
    const std::uint32_t count = call(place_, api().sensor_list_get_count, all);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (call(place_, api().sensor_list_get_sensor_type, all, i) == type) return true;
    }
    return false;
  }

  std::vector<Mode> modes(int sensor) const {
    if (!has_sensor(sensor)) return {};
    return modes_of(hold(call(place_, api().pipeline_get_stream_profile_list,
                              static_cast<const ob::Pipeline*>(pipeline_.get()), sensor),
                         api().delete_stream_profile_list),
                    place_);
  }

  void choose_modes() {
    std::vector<Mode> depths = modes(ob::kDepth), colours = modes(ob::kColour);
    Mode* depth = choose_depth_mode(depths);
    if (depth == nullptr) throw Error(place_ + ": it has no depth, expected a depth camera");
    Mode* colour = choose_colour(colours, *depth);
    has_colour_ = colour != nullptr;
    if (has_colour_) grid_ = std::move(colour->profile);
    (has_colour_ ? depth_mode_ : grid_) = std::move(depth->profile);
    if (!has_colour_) notes_.push_back(place_ + ": depth alone, since it gives no RGB");
    const LensCamera lens = lens_of(grid_.get());
    camera_ = lens.camera;
    if (lens.lens != Lens{}) rectification_.emplace(lens, camera_);
  }

  LensCamera lens_of(const ob::StreamProfile* stream) {
    const ob::Intrinsics pinhole = call(place_, api().video_stream_profile_get_intrinsic, stream);
    const ob::Distortion lens = call(place_, api().video_stream_profile_get_distortion, stream);
    const bool known = lens.model >= 0 && lens.model < int(kOrbbecLenses.size());
    const std::string_view model = known ? kOrbbecLenses[static_cast<std::size_t>(lens.model)] : "of a later version";
    return with_lens({pinhole.width, pinhole.height, pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy}, model,
                     coefficients_of(lens));
  }

  void start() {
    const auto config = hold(call(place_, api().create_config), api().delete_config);
    for (const auto* mode : {&grid_, &depth_mode_}) {
      if (!*mode) continue;
      call(place_, api().config_enable_stream_with_stream_profile, config.get(),
           static_cast<const ob::StreamProfile*>(mode->get()));
    }
    call(place_, api().config_set_frame_aggregate_output_mode, config.get(), ob::kAllStreams);
    if (has_colour_) {
      Outcome<ob::Failure> unable(place_);  // then the SDK pairs what comes together
      api().pipeline_enable_frame_sync(pipeline_.get(), unable.out());
      align_ = hold(call(place_, api().create_filter, "Align"), api().delete_filter);
      set("AlignType", ob::kColour);
      // So that depth lies on a grid without distortion, which `camera_` describes, and is resampled once only.
      is_registered_without_lens_ = set("TargetDistortion", 0);
      set("MatchTargetRes", 1);
      set("GapFillCopy", 1);  // where the grid is finer than depth
    }
    Outcome<ob::Failure> outcome(place_);
    api().pipeline_start_with_config(pipeline_.get(), config.get(), outcome.out());
    if (outcome.failed()) fail_to_open(place_, outcome.reason());
  }

  /// Returns whether the SDK knows of such a value. What a version does not know it cannot be told, and its own choice
  /// stays.
  bool set(const char* name, double value) {
    Outcome<ob::Failure> unknown(place_);
    api().filter_set_config_value(align_.get(), name, value, unknown.out());
    return !unknown.failed();
  }

  void start_acceleration() {
    try {
      acceleration_.emplace(device_.get(), place_);
    } catch (const Error& e) {
      notes_.push_back(fmt::format("{}; its frames have no direction of gravity", e.what()));
    }
  }

  /// Waits for the next pictures, puts depth onto the grid of colour, and returns both; without depth if none came.
  Pictures wait(std::chrono::milliseconds patience) {
    Pictures pictures;
    auto all = hold(
        call(place_, api().pipeline_wait_for_frameset, pipeline_.get(), static_cast<std::uint32_t>(patience.count())),
        api().delete_frame);
    if (!all) return pictures;
    pictures.original = picture(all.get(), api().frameset_get_depth_frame);
    if (!pictures.original) return pictures;
    if (has_colour_) {
      all = hold(call(place_, api().filter_process, align_.get(), static_cast<const ob::Frame*>(all.get())),
                 api().delete_frame);
      if (!all) return pictures;
      pictures.colour = picture(all.get(), api().frameset_get_color_frame);
      if (!pictures.colour) return pictures;
    }
    pictures.depth = picture(all.get(), api().frameset_get_depth_frame);
    return pictures;
  }

  Held<ob::Frame> picture(const ob::Frame* all, ob::Frame* (*get)(const ob::Frame*, ob::Failure**)) const {
    return hold(call(place_, get, all), api().delete_frame);
  }

  template <class T>
  void copy(const ob::Frame* from, Image<T>& to, const char* what) const {
    const auto width = call(place_, api().video_frame_get_width, from);
    const auto height = call(place_, api().video_frame_get_height, from);
    const std::size_t row = sizeof(T) * static_cast<std::size_t>(to.width());
    if (int(width) != to.width() || int(height) != to.height() ||
        call(place_, api().frame_get_data_size, from) < row * static_cast<std::size_t>(to.height())) {
      throw Error(fmt::format("{}: {} of {}x{}, expected {}x{} with {} bytes a pixel", place_, what, width, height,
                              to.width(), to.height(), sizeof(T)));
    }
    copy_rows(call(place_, api().frame_get_data, from), row, to);
  }

  Held<ob::Context> context_;
  Held<ob::Device> device_;
  Held<ob::Pipeline> pipeline_;
  Held<ob::StreamProfile> grid_;        ///< the stream on whose grid frames lie
  Held<ob::StreamProfile> depth_mode_;  ///< where that is colour's
  Held<ob::Filter> align_;
  std::optional<OrbbecAccelerometer> acceleration_;
  Camera camera_;
  /// Undoes the lens of that stream where it distorts.
  std::optional<Rectification> rectification_;
  bool is_registered_without_lens_ = false;  ///< whether depth lies on that grid with the lens undone already
  bool has_colour_ = false;
  std::int64_t last_index_ = -1;
};

}  // namespace

std::vector<SensorInfo> list_orbbec() {
  const auto context = make_context();
  return infos_of(devices_of(context.get()).get());
}

std::unique_ptr<FrameSource> open_orbbec(const std::string& id) { return std::make_unique<OrbbecSource>(id); }

}  // namespace vesalius
