#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// What a camera's sensor of acceleration measured at a time, in the optical frame of depth: at rest the force against
/// gravity, (0, -9.81, 0) m/s² of a level camera.
struct TimedAcceleration {
  double time_s = 0.0;
  Eigen::Vector3d m_s2 = Eigen::Vector3d::Zero();
};

/// Reads a kAccelerationFile: lines "time_s,x,y,z", before which a line of four names may stand. Times are those of
/// clock_seconds. Empty lines and those that begin with # are skipped; blanks or tabs may stand for commas. The
/// measurements are sorted by time. Throws Error naming `name` and the line if a line has not four numbers.
std::vector<TimedAcceleration> parse_accelerations(std::string_view text, const std::string& name);

/// Returns the text of such a file.
std::string serialise_accelerations(const std::vector<TimedAcceleration>& measured);

}  // namespace vesalius
