#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "io/recordings/recording.h"

namespace vesalius {

/// What an accelerometer measures at rest.
inline constexpr double kGravity_m_s2 = 9.80665;

/// What an accelerometer measured: sensor_msgs/Imu. At rest that is 9.8 m/s² away from the ground.
struct Acceleration {
  std::int64_t time_ns = 0;                        ///< time of the header; 0 = not given
  std::string frame;                               ///< name of the coordinate frame
  Eigen::Vector3d m_s2 = Eigen::Vector3d::Zero();  ///< 0 where the message says that it is not known
};

/// Returns whether a topic has accelerations. RealSense cameras have gyroscopes on topics of the same type.
bool is_acceleration(const RecordedTopic& topic);

/// Reads a message of a topic that is_acceleration. Throws Error naming `name`.
Acceleration parse_acceleration(const RecordedTopic& topic, std::string_view message, const std::string& name);

/// Returns a sensor_msgs/Imu as CDR. An acceleration of 0 is not known; how the sensor turns and its orientation are
/// not either.
std::string acceleration_message(const Acceleration& acceleration);
/// Returns that of a sensor at rest, which feels gravity; without `up` its acceleration is not known.
std::string imu_message(const std::optional<Eigen::Vector3f>& up, std::int64_t time_ns, std::string_view frame);

/// Tells from the accelerations of the last moments where up is.
class UpHistory {
 public:
  /// Adds a measurement in the optical frame of the camera.
  void add(std::int64_t time_ns, const Eigen::Vector3d& acceleration_m_s2);
  /// Forgets all.
  void clear() { samples_.clear(); }

  /// Returns the direction of the mean acceleration over the half second that ends at `time_ns`, in the optical frame;
  /// nothing where none was measured, or its length says that the camera was shaken or falls: 9.3 to 10.3 m/s² is
  /// gravity. A measurement of exactly that time counts alone: it was made for the frame, as `vesalius record` does.
  std::optional<Eigen::Vector3f> up_at(std::int64_t time_ns) const;

 private:
  struct Sample {
    std::int64_t time_ns;
    Eigen::Vector3d acceleration_m_s2;
  };
  std::deque<Sample> samples_;
};

}  // namespace vesalius
