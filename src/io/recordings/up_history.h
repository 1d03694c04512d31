#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>

namespace vesalius {

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
