#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/image_bytes.h"
#include "io/lens/colour_registration.h"
#include "io/lens/lens.h"
#include "io/sensors/live_source.h"
#include "io/sensors/realsense_api.h"
#include "io/sensors/run_time_library.h"
#include "io/sensors/sensor_drivers.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using rs2::api;

/// Of rs2_distortion, in its order.
constexpr std::array<std::string_view, 6> kRealSenseLenses{"none",    "modified Brown-Conrady", "inverse Brown-Conrady",
                                                           "F-theta", "Brown-Conrady",          "Kannala-Brandt4"};

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

/// Returns the first of a list that is of this kind of stream, null if none is. The list owns it.
const rs2::StreamProfile* find_stream(const rs2::StreamProfileList* list, int stream, const std::string& place) {
  const int count = call(place, api().get_stream_profiles_count, list);
  for (int i = 0; i < count; ++i) {
    const rs2::StreamProfile* one = call(place, api().get_stream_profile, list, i);
    int of = 0, format = 0, index = 0, id = 0, rate = 0;
    call(place, api().get_stream_profile_data, one, &of, &format, &index, &id, &rate);
    if (of == stream && (stream != rs2::kAcceleration || format == rs2::kXyz32f)) return one;
  }
  return nullptr;
}

/// The sensor of acceleration of a camera, apart from the pictures, which must not wait for it. A camera without one,
/// or whose one does not start, has no `up`.
class RealSenseAccelerometer {
 public:
  RealSenseAccelerometer(const rs2::Device* device, std::string place)
      : place_(std::move(place)), queue_(call(place_, api().create_frame_queue, 1), api().delete_frame_queue) {
    const Owned<rs2::SensorList> all(call(place_, api().query_sensors, device), api().delete_sensor_list);
    const auto* const list = static_cast<const rs2::SensorList*>(all.get());
    const int count = call(place_, api().get_sensors_count, list);
    for (int i = 0; i < count && profile_ == nullptr; ++i) {
      sensor_ = {call(place_, api().create_sensor, list, i), api().delete_sensor};
      profiles_ = {call(place_, api().get_stream_profiles, sensor_.get()), api().delete_stream_profiles_list};
      profile_ = find_stream(profiles_.get(), rs2::kAcceleration, place_);
    }
    if (profile_ != nullptr) start();
  }
  ~RealSenseAccelerometer() {
    Outcome<rs2::Failure> stopping(place_), closing(place_);  // what fails now is of no interest
    if (started_) api().stop(sensor_.get(), stopping.out());
    if (started_) api().close(sensor_.get(), closing.out());
  }
  RealSenseAccelerometer(const RealSenseAccelerometer&) = delete;
  RealSenseAccelerometer& operator=(const RealSenseAccelerometer&) = delete;

  /// Returns the direction away from the ground in the optical frame of a stream, by the newest measurement.
  std::optional<Eigen::Vector3f> up(const rs2::StreamProfile* in) {
    if (!started_) return std::nullopt;
    rs2::Frame* polled = nullptr;
    while (call(place_, api().poll_for_frame, queue_.get(), &polled) != 0) {
      const Owned<rs2::Frame> frame(polled, api().release_frame);
      const auto* data = call(place_, api().get_frame_data, static_cast<const rs2::Frame*>(frame.get()));
      if (data != nullptr) std::memcpy(measured_.data(), data, sizeof measured_);
    }
    rs2::Extrinsics to{};
    Outcome<rs2::Failure> unknown(place_);
    api().get_extrinsics(profile_, in, &to, unknown.out());
    if (unknown.failed()) return std::nullopt;
    return up_of(Eigen::Map<const Eigen::Matrix3f>(to.rotation) * measured_);
  }

 private:
  void start() {
    Outcome<rs2::Failure> opening(place_), starting(place_), closing(place_);
    api().open(sensor_.get(), profile_, opening.out());
    if (opening.failed()) return;
    api().start_queue(sensor_.get(), queue_.get(), starting.out());
    started_ = !starting.failed();
    if (!started_) api().close(sensor_.get(), closing.out());
  }

  std::string place_;
  Owned<rs2::Queue> queue_;
  Owned<rs2::Sensor> sensor_{nullptr, nullptr};
  Owned<rs2::StreamProfileList> profiles_{nullptr, nullptr};
  const rs2::StreamProfile* profile_ = nullptr;
  bool started_ = false;
  Eigen::Vector3f measured_ = Eigen::Vector3f::Zero();  ///< m/s2
};

class RealsenseSource final : public LiveSource {
 public:
  explicit RealsenseSource(const std::string& id)
      : LiveSource("realsense", id),
        context_(make_context()),
        pipeline_(call(place_, api().create_pipeline, context_.get()), api().delete_pipeline) {
    const bool is_file = std::filesystem::is_regular_file(id);
    if (!is_file) expect_plugged_in("realsense", all_plugged_in(context_.get()), id);
    start(id, is_file);
    use_lenses();
    start_acceleration();
  }

  ~RealsenseSource() override {
    acceleration_.reset();
    Outcome<rs2::Failure> ignored(place_);
    if (profile_) api().pipeline_stop(pipeline_.get(), ignored.out());
  }

  std::optional<Frame> next() override {
    for (;;) {
      Owned<rs2::Frame> all = wait();
      if (!all) return std::nullopt;
      const double arrived_s = now_s();
      const Owned<rs2::Frame> depth = stream_of(all.get(), rs2::kDepth);
      if (!depth) continue;
      const rs2::Frame* of = depth.get();
      const auto number = static_cast<std::int64_t>(call(place_, api().get_frame_number, of));
      // Where colour comes late, the library gives the same depth once more.
      if (number == last_number_) continue;
      if (last_number_ >= 0 && number > last_number_ + 1) missed_ += int(number - last_number_ - 1);
      last_number_ = number;
      Frame frame = arrived(1e-3 * call(place_, api().get_frame_timestamp, of));
      frame.arrived_s = arrived_s;
      if (acceleration_) frame.up = acceleration_->up(call(place_, api().get_frame_stream_profile, of));
      frame.camera = camera_;
      frame.depth = depth_of(of);
      if (const Owned<rs2::Frame> colour = registration_ ? stream_of(all.get(), rs2::kColour) : none()) {
        const ColourImage picture = picture_of<Rgb>(colour.get());
        if (registration_->fits(picture)) frame.colour = (*registration_)(frame.depth, picture);
      }
      return frame;
    }
  }

 private:
  static Owned<rs2::Frame> none() { return {nullptr, api().release_frame}; }

  /// Returns the next frames of all streams; null after `stop`.
  Owned<rs2::Frame> wait() {
    Owned<rs2::Frame> all = none();
    wait_for_frame([&](std::chrono::milliseconds patience) {
      rs2::Frame* came = nullptr;
      const auto patience_ms = static_cast<unsigned>(patience.count());
      if (call(place_, api().pipeline_try_wait_for_frames, pipeline_.get(), &came, patience_ms) == 0) return false;
      all.reset(came);
      return true;
    });
    return all;
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
      const int width = is_file ? 0 : kCameraWidth, height = is_file ? 0 : kCameraHeight,
                rate = is_file ? 0 : kCameraRate;
      call(place_, api().config_enable_stream, config.get(), rs2::kDepth, -1, width, height, rs2::kZ16, rate);
      if (colour)
        call(place_, api().config_enable_stream, config.get(), rs2::kColour, -1, width, height, rs2::kRgb8, rate);
      Outcome<rs2::Failure> outcome(place_);
      profile_ = {api().pipeline_start_with_config(pipeline_.get(), config.get(), outcome.out()),
                  api().delete_pipeline_profile};
      if (profile_ && !colour) notes_.push_back(place_ + ": depth alone, since it has no colour");
      if (profile_) return;
      if (!colour) fail_to_open(place_, outcome.reason());
    }
  }

  /// Frames have the grid of depth, and colour is put onto it as that of recordings is. The library's own way, which
  /// puts depth onto the grid of colour, forgets the lens of colour where it uses SSE.
  void use_lenses() {
    const Owned<rs2::StreamProfileList> list(call(place_, api().pipeline_profile_get_streams, profile_.get()),
                                             api().delete_stream_profiles_list);
    const rs2::StreamProfile* depth = find_stream(list.get(), rs2::kDepth, place_);
    const rs2::StreamProfile* colour = find_stream(list.get(), rs2::kColour, place_);
    if (depth == nullptr) throw Error(place_ + ": it has no depth, expected a depth camera");
    const LensCamera lens = lens_of(depth);
    camera_ = lens.camera;
    if (lens.lens != Lens{}) rectification_.emplace(lens, camera_);
    if (colour == nullptr) return;
    rs2::Extrinsics to{};
    Outcome<rs2::Failure> unknown(place_);
    api().get_extrinsics(depth, colour, &to, unknown.out());
    if (unknown.failed()) {
      notes_.push_back(place_ + ": depth alone, since nothing says where its colour camera is");
      return;
    }
    Eigen::Isometry3d colour_from_depth = Eigen::Isometry3d::Identity();
    colour_from_depth.linear() = Eigen::Map<const Eigen::Matrix3f>(to.rotation).cast<double>();
    colour_from_depth.translation() = Eigen::Map<const Eigen::Vector3f>(to.translation).cast<double>();
    registration_.emplace(camera_, lens_of(colour), colour_from_depth);
  }

  LensCamera lens_of(const rs2::StreamProfile* stream) {
    constexpr int kMostOfFisheye = 4;
    rs2::Intrinsics lens{};
    call(place_, api().get_video_stream_intrinsics, stream, &lens);
    const bool known = lens.model >= 0 && lens.model < int(kRealSenseLenses.size());
    const std::string_view model =
        known ? kRealSenseLenses[static_cast<std::size_t>(lens.model)] : "of a later version";
    std::vector<double> coefficients(std::begin(lens.coefficients), std::end(lens.coefficients));
    if (lens.model == rs2::kNoDistortion) coefficients.clear();
    if (lens.model == rs2::kKannalaBrandt) coefficients.resize(kMostOfFisheye);
    return with_lens({lens.width, lens.height, lens.fx, lens.fy, lens.ppx, lens.ppy}, model, coefficients);
  }

  void start_acceleration() {
    const Owned<rs2::Device> device(call(place_, api().pipeline_profile_get_device, profile_.get()),
                                    api().delete_device);
    try {
      acceleration_.emplace(device.get(), place_);
    } catch (const Error& e) {
      notes_.push_back(fmt::format("{}; its frames have no direction of gravity", e.what()));
    }
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

  template <class T>
  Image<T> picture_of(const rs2::Frame* frame) const {
    Image<T> picture(call(place_, api().get_frame_width, frame), call(place_, api().get_frame_height, frame));
    const auto stride = static_cast<std::size_t>(call(place_, api().get_frame_stride_in_bytes, frame));
    const auto* data = call(place_, api().get_frame_data, frame);
    copy_rows(data, stride, picture);
    return picture;
  }

  DepthImage depth_of(const rs2::Frame* frame) const {
    auto depth = picture_of<std::uint16_t>(frame);
    if (depth.width() != camera_.width || depth.height() != camera_.height) {
      throw Error(fmt::format("{}: depth of {}x{}, expected {}x{} of its calibration", place_, depth.width(),
                              depth.height(), camera_.width, camera_.height));
    }
    to_millimetres(depth, 1e3 * double(call(place_, api().depth_frame_get_units, frame)));
    return rectification_ ? rectification_->depth(depth) : std::move(depth);
  }

  Owned<rs2::Context> context_;
  Owned<rs2::Pipeline> pipeline_;
  Owned<rs2::PipelineProfile> profile_{nullptr, nullptr};
  std::optional<RealSenseAccelerometer> acceleration_;
  Camera camera_;  ///< camera of frames: the depth camera without its lens
  std::optional<Rectification> rectification_;
  std::optional<ColourRegistration> registration_;
  std::int64_t last_number_ = -1;
};

}  // namespace

std::vector<SensorInfo> list_realsense() { return all_plugged_in(make_context().get()); }

std::unique_ptr<FrameSource> open_realsense(const std::string& id) { return std::make_unique<RealsenseSource>(id); }

}  // namespace vesalius
