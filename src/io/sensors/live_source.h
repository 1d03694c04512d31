#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/lens/lens.h"
#include "vesalius/frame_source.h"
#include "vesalius/image.h"

namespace vesalius {

/// The mode of cameras that have several: pictures of this size, so many a second.
inline constexpr int kCameraWidth = 640, kCameraHeight = 480, kCameraRate = 30;

/// Microseconds of a second.
inline constexpr double kMicroseconds = 1e6;

/// Time without a frame after which a camera counts as lost.
inline constexpr std::chrono::milliseconds kSensorPatience(3000);

/// Returns the direction away from the ground, given what a sensor of acceleration measures: at rest that is the force
/// against gravity, so it points up. Nothing where the camera is moved, that is unless the magnitude lies within a
/// tenth of 9.81 m/s2: uncalibrated sensors are off by up to 5 %.
std::optional<Eigen::Vector3f> up_of(const Eigen::Vector3f& acceleration_mps2);

/// Returns the time now for Frame::arrived_s.
double now_s();

/// Sets the time of a frame, by the camera's clock, and the name after it.
void set_time(Frame& frame, double time_s);

/// What all cameras have in common as sources.
class LiveSource : public FrameSource {
 public:
  int size() const override { return -1; }
  bool is_live() const override { return true; }
  int missed() const override { return missed_; }
  std::vector<std::string> notes() const override { return notes_; }
  void stop() override { stopped_ = true; }

 protected:
  LiveSource(std::string_view scheme, const std::string& id);

  /// Calls `has_frame(patience)`, which waits for at most so long, until it returns true. Returns false after `stop`.
  /// Throws Error where no frame comes for kSensorPatience.
  template <class HasFrame>
  bool wait_for_frame(HasFrame has_frame) {
    constexpr std::chrono::milliseconds kBetweenQuestions(100);
    const auto end = std::chrono::steady_clock::now() + kSensorPatience;
    while (!stopped_) {
      if (has_frame(kBetweenQuestions)) return true;
      if (std::chrono::steady_clock::now() >= end) fail_without_frame();
    }
    return false;
  }
  [[noreturn]] void fail_without_frame() const;

  /// Returns a camera with the lens that its driver states, as `make_lens` knows it. A lens that distorts by another
  /// model stays undone, and a note says so.
  LensCamera with_lens(const Camera& camera, std::string_view model, const std::vector<double>& coefficients);

  /// Returns an empty frame that arrives now and was taken at `time_s` of the camera's clock.
  static Frame arrived(double time_s);

  std::string place_;  ///< for messages
  std::vector<std::string> notes_;
  std::atomic<int> missed_ = 0;

 private:
  std::atomic<bool> stopped_ = false;
};

/// Turns depth in other units into millimetres, each of them `to_mm` long. What is beyond 65.5 m becomes no reading.
inline void to_millimetres(DepthImage& depth, double to_mm) {
  constexpr double kSame = 1e-6;
  if (std::abs(to_mm - 1.0) < kSame) return;
  for (std::uint16_t& z : depth) {
    const double z_mm = to_mm * z;
    z = z_mm < std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(std::lround(z_mm))
                                                         : std::uint16_t{0};
  }
}

}  // namespace vesalius
