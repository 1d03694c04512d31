#include "dataset/tum_trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
constexpr double kLongestGap_s = 0.15;  // the benchmark's motion capture gives 100 poses a second
constexpr double kHalfSpan_s = 0.05;    // half of the time over which motion is measured
constexpr double kStill_m_s = 0.05;
constexpr double kStill_deg_s = 5.0;

/// Returns the eight numbers of a line, or nothing if the line has any other form.
std::optional<std::array<double, 8>> numbers(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r";
  std::array<double, 8> values{};
  for (double& value : values) {
    line.remove_prefix(std::min(line.find_first_not_of(kSpace), line.size()));
    const char* end = line.data() + line.size();
    const auto [stop, error] = std::from_chars(line.data(), end, value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    if (stop != end && kSpace.find(*stop) == kSpace.npos) return std::nullopt;
    line.remove_prefix(stop - line.data());
  }
  if (line.find_first_not_of(kSpace) != line.npos) return std::nullopt;
  return values;
}

}  // namespace

Trajectory Trajectory::parse(std::string_view text, const std::string& name) {
  Trajectory trajectory;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == line.npos || line[begin] == '#') continue;
    const auto v = numbers(line);
    if (!v) throw Error(fmt::format("{}:{}: expected \"timestamp tx ty tz qx qy qz qw\"", name, number));
    const auto& [time_s, x, y, z, qx, qy, qz, qw] = *v;
    const Eigen::Quaterniond rotation(qw, qx, qy, qz);
    if (std::abs(rotation.norm() - 1.0) > 0.01) {
      throw Error(fmt::format("{}:{}: a quaternion of length {}, expected 1", name, number, rotation.norm()));
    }
    if (!trajectory.poses_.empty() && time_s <= trajectory.poses_.back().time_s) {
      throw Error(fmt::format("{}:{}: a time that does not come after the one before", name, number));
    }
    trajectory.poses_.push_back({time_s, {x, y, z}, rotation.normalized()});
  }
  if (trajectory.poses_.empty()) throw Error(name + ": no pose, expected \"timestamp tx ty tz qx qy qz qw\"");
  return trajectory;
}

Trajectory Trajectory::read(const std::string& path) { return parse(read_file(path, kMaxBytes), path); }

std::optional<Eigen::Isometry3d> Trajectory::world_from_camera(double time_s) const {
  const auto after = std::ranges::lower_bound(poses_, time_s, {}, &Pose::time_s);
  if (after == poses_.end()) return std::nullopt;
  Pose pose = *after;
  if (pose.time_s != time_s) {
    if (after == poses_.begin()) return std::nullopt;
    const Pose& before = *(after - 1);
    const double gap_s = after->time_s - before.time_s;
    if (gap_s > kLongestGap_s) return std::nullopt;
    const double share = (time_s - before.time_s) / gap_s;
    pose.position_m = before.position_m + share * (after->position_m - before.position_m);
    pose.rotation = before.rotation.slerp(share, after->rotation);
  }
  return Eigen::Translation3d(pose.position_m) * pose.rotation;
}

CameraMotion Trajectory::motion(double time_s) const {
  const auto before = world_from_camera(time_s - kHalfSpan_s);
  const auto after = world_from_camera(time_s + kHalfSpan_s);
  if (!before || !after) return CameraMotion::unknown;
  const Eigen::Isometry3d step = before->inverse() * *after;
  const double span_s = 2.0 * kHalfSpan_s;
  const double turned_deg = Eigen::AngleAxisd(step.rotation()).angle() * 180.0 / std::numbers::pi;
  const bool moving = step.translation().norm() >= kStill_m_s * span_s || turned_deg >= kStill_deg_s * span_s;
  return moving ? CameraMotion::moving : CameraMotion::still;
}

}  // namespace vesalius
