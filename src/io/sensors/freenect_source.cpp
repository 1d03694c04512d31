#include <fmt/format.h>
#include <libfreenect.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "io/sensors/live_source.h"
#include "io/sensors/sensor_drivers.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Of the colour camera, on whose grid registered depth lies; cameras differ by a few pixels.
constexpr float kFocal_px = 525.F;
constexpr double kTicks_s = 60e6;
/// How far a colour picture's time may lie from depth's: half the time between two frames.
constexpr std::int64_t kMostApart = static_cast<std::int64_t>(kTicks_s / 60.0);
constexpr std::int64_t kBetweenFrames = static_cast<std::int64_t>(kTicks_s / 30.0);
constexpr std::chrono::milliseconds kColourPatience(20);
constexpr std::chrono::milliseconds kBetweenTilts(200);

struct CloseDevice {
  void operator()(freenect_device* device) const { freenect_close_device(device); }
};
struct Shutdown {
  void operator()(freenect_context* context) const { freenect_shutdown(context); }
};
using Context = std::unique_ptr<freenect_context, Shutdown>;

Context make_context() {
  freenect_context* made = nullptr;
  if (freenect_init(&made, nullptr) < 0) throw Error("freenect: the library does not start");
  Context context(made);
  freenect_set_log_level(made, FREENECT_LOG_FATAL);
  return context;
}

std::vector<SensorInfo> all_plugged_in(freenect_context* context) {
  std::vector<SensorInfo> infos;
  if (freenect_num_devices(context) <= 0) return infos;
  freenect_device_attributes* first = nullptr;
  freenect_list_device_attributes(context, &first);
  for (const freenect_device_attributes* one = first; one != nullptr; one = one->next) {
    infos.push_back({one->camera_serial, "Kinect v1"});
  }
  freenect_free_device_attributes(first);
  return infos;
}

/// Asks the base of a Kinect, where its sensor of acceleration is, for the direction away from the ground. That has a
/// thread of its own: a question takes as long as the base likes.
class TiltWatch {
 public:
  explicit TiltWatch(freenect_device* device)
      : thread_([this, device](const std::stop_token& stop) { watch(device, stop); }) {}

  std::optional<Eigen::Vector3f> up() const {
    const std::scoped_lock lock(mutex_);
    return up_;
  }

 private:
  void watch(freenect_device* device, const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::optional<Eigen::Vector3f> up;
      if (freenect_update_tilt_state(device) >= 0) up = measured(freenect_get_tilt_state(device));
      std::unique_lock lock(mutex_);
      up_ = up;
      asked_.wait_for(lock, stop, kBetweenTilts, [] { return false; });
    }
  }

  static std::optional<Eigen::Vector3f> measured(freenect_raw_tilt_state* state) {
    std::array<double, 3> a{};
    freenect_get_mks_accel(state, &a[0], &a[1], &a[2]);
    // Its axes point to the camera's left, up and forward (docs/cameras.md).
    return up_of(Eigen::Vector3d(-a[0], -a[1], a[2]).cast<float>());
  }

  mutable std::mutex mutex_;
  std::condition_variable_any asked_;
  std::optional<Eigen::Vector3f> up_;
  std::jthread thread_;
};

/// The newest picture of a stream, and when it was taken, in ticks of the camera's clock.
template <class Picture>
struct Newest {
  Picture picture;
  std::int64_t time = 0;
  int count = 0;  ///< number of pictures that came
  double arrived_s = 0.0;
};

class FreenectSource final : public LiveSource {
 public:
  explicit FreenectSource(const std::string& id) : LiveSource("freenect", id), context_(make_context()) {
    open(id);
    notes_.push_back(
        fmt::format("{}: a focal length of {:.4g} pixels assumed, usual for a Kinect v1", place_, kFocal_px));
    freenect_set_user(device_.get(), this);
    freenect_set_depth_callback(device_.get(), [](freenect_device* device, void* depth, std::uint32_t time) {
      static_cast<FreenectSource*>(freenect_get_user(device))->take_depth(depth, time);
    });
    freenect_set_video_callback(device_.get(), [](freenect_device* device, void* video, std::uint32_t time) {
      static_cast<FreenectSource*>(freenect_get_user(device))->take_colour(video, time);
    });
    expect(freenect_set_depth_mode(device_.get(),
                                   freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_REGISTERED)),
           "has no registered depth");
    expect(freenect_set_video_mode(device_.get(),
                                   freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_VIDEO_RGB)),
           "has no colour");
    expect(freenect_start_depth(device_.get()), "gives no depth");
    expect(freenect_start_video(device_.get()), "gives no colour");
    events_ = std::jthread([this](const std::stop_token& stop) { run_events(stop); });
    if (has_base_) tilt_.emplace(device_.get());
  }

  ~FreenectSource() override {
    tilt_.reset();
    events_.request_stop();
    events_.join();
    freenect_stop_depth(device_.get());
    freenect_stop_video(device_.get());
  }

  std::optional<Frame> next() override {
    std::unique_lock lock(mutex_);
    const auto has_frame = [&](std::chrono::milliseconds patience) {
      came_.wait_for(lock, patience, [&] { return depth_.count > taken_ || failed_; });
      if (depth_.count == taken_ && failed_) throw Error(place_ + ": it stopped; unplugged, or its driver failed");
      return depth_.count > taken_;
    };
    if (!wait_for_frame(has_frame)) return std::nullopt;
    missed_ += taken_ > 0 ? depth_.count - taken_ - 1 : 0;
    taken_ = depth_.count;
    Frame frame = arrived(double(depth_.time) / kTicks_s);
    frame.arrived_s = depth_.arrived_s;
    if (tilt_) frame.up = tilt_->up();
    frame.camera = {
        kCameraWidth, kCameraHeight, kFocal_px, kFocal_px, (kCameraWidth - 1) / 2.F, (kCameraHeight - 1) / 2.F};
    frame.depth = depth_.picture;
    const std::int64_t time = depth_.time;
    came_.wait_for(lock, kColourPatience, [&] { return colour_.time >= time - kMostApart && colour_.count > 0; });
    if (colour_.count > 0 && std::abs(colour_.time - time) <= kMostApart) frame.colour = colour_.picture;
    return frame;
  }

 private:
  void expect(int status, const char* what) const {
    if (status < 0) throw Error(fmt::format("{} {}", place_, what));
  }

  void open(const std::string& id) {
    // Serial numbers cost questions to every Kinect, and one that another program uses gives none.
    const int count = freenect_num_devices(context_.get());
    if (id.empty() ? count != 1 : count <= 0) expect_plugged_in("freenect", all_plugged_in(context_.get()), id);
    // Some have no base of their own, and no camera is worth less for that.
    for (const bool base : {true, false}) {
      const int parts = base ? FREENECT_DEVICE_CAMERA | FREENECT_DEVICE_MOTOR : FREENECT_DEVICE_CAMERA;
      freenect_select_subdevices(context_.get(), static_cast<freenect_device_flags>(parts));
      freenect_device* opened = nullptr;
      const int status = id.empty() ? freenect_open_device(context_.get(), &opened, 0)
                                    : freenect_open_device_by_camera_serial(context_.get(), &opened, id.c_str());
      if (status < 0) continue;
      device_.reset(opened);
      has_base_ = base;
      return;
    }
    fail_to_open(place_, id.empty() ? "" : "not there, or in use");
  }

  void run_events(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      constexpr int kWait_us = 100'000;
      timeval wait{0, kWait_us};
      if (freenect_process_events_timeout(context_.get(), &wait) >= 0) continue;
      const std::scoped_lock lock(mutex_);
      failed_ = true;
      came_.notify_all();
      return;
    }
  }

  /// Returns the camera's time without the jump of its 32 bits after 71 s.
  std::int64_t whole(std::uint32_t time) {
    if (!started_) whole_ = last_ = time;
    started_ = true;
    whole_ += static_cast<std::int32_t>(time - last_);
    last_ = time;
    return whole_;
  }

  void take_depth(const void* data, std::uint32_t time) {
    const std::scoped_lock lock(mutex_);
    depth_.arrived_s = now_s();
    depth_.picture = DepthImage(kCameraWidth, kCameraHeight);
    std::memcpy(depth_.picture.data(), data, depth_.picture.size() * sizeof(std::uint16_t));
    const std::int64_t before = depth_.time;
    depth_.time = whole(time);
    // Packets that were lost on the way are frames too.
    const std::int64_t periods = depth_.count == 0 ? 1 : (depth_.time - before + kBetweenFrames / 2) / kBetweenFrames;
    depth_.count += int(std::max<std::int64_t>(1, periods));
    came_.notify_all();
  }

  void take_colour(const void* data, std::uint32_t time) {
    const std::scoped_lock lock(mutex_);
    colour_.picture = ColourImage(kCameraWidth, kCameraHeight);
    std::memcpy(static_cast<void*>(colour_.picture.data()), data, colour_.picture.size() * sizeof(Rgb));
    colour_.time = whole(time);
    ++colour_.count;
    came_.notify_all();
  }

  Context context_;
  std::unique_ptr<freenect_device, CloseDevice> device_;
  std::mutex mutex_;  ///< guards all that follows
  std::condition_variable came_;
  Newest<DepthImage> depth_;
  Newest<ColourImage> colour_;
  bool started_ = false;
  std::uint32_t last_ = 0;
  std::int64_t whole_ = 0;
  int taken_ = 0;
  bool failed_ = false;
  std::jthread events_;
  bool has_base_ = false;
  std::optional<TiltWatch> tilt_;
};

}  // namespace

std::vector<SensorInfo> list_freenect() { return all_plugged_in(make_context().get()); }

std::unique_ptr<FrameSource> open_freenect(const std::string& id) { return std::make_unique<FreenectSource>(id); }

}  // namespace vesalius
