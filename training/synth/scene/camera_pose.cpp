#include "synth/scene/camera_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kRadPerDeg = std::numbers::pi_v<float> / 180.F;

float between(float low, float high, Random& random) { return float(random.uniform(low, high)); }

void check_order(const char* low_name, float low, const char* high_name, float high) {
  if (low > high) throw UsageError(fmt::format("option {} is {}, above {} {}", low_name, low, high_name, high));
}

}  // namespace

CameraPlacement camera_placement(const std::string& mounting) {
  CameraPlacement placement;
  if (mounting == "room") return placement;
  if (mounting == "ceiling") {
    placement.height_min_m = 2.2F;
    placement.height_max_m = 3.F;
    placement.pitch_min_deg = 50.F;
    placement.pitch_max_deg = 90.F;
    placement.aim_error_deg = 10.F;
    placement.usual_max_m = 3.F;
    placement.distance_max_m = 4.5F;
    return placement;
  }
  if (mounting == "wheelchair") {
    placement.height_min_m = 0.6F;
    placement.height_max_m = 1.1F;
    placement.pitch_min_deg = -25.F;
    placement.pitch_max_deg = 20.F;
    placement.distance_min_m = 0.5F;
    placement.usual_min_m = 0.8F;
    placement.usual_max_m = 2.5F;
    return placement;
  }
  throw UsageError(fmt::format("camera mounting \"{}\", expected room, ceiling or wheelchair", mounting));
}

void visit_options(const std::string& prefix, CameraPlacement& o, OptionVisitor& visitor) {
  visitor.option(prefix + "height-min", o.height_min_m, {"m", 0.2, 4.0, "Lowest camera above the floor."});
  visitor.option(prefix + "height-max", o.height_max_m, {"m", 0.2, 4.0, "Highest camera above the floor."});
  visitor.option(prefix + "pitch-min", o.pitch_min_deg, {"deg", -60.0, 90.0, "Least tilt downwards."});
  visitor.option(prefix + "pitch-max", o.pitch_max_deg, {"deg", -60.0, 90.0, "Greatest tilt downwards; 90: straight."});
  visitor.option(prefix + "roll-max", o.roll_max_deg, {"deg", 0.0, 180.0, "Greatest tilt to either side."});
  visitor.option(prefix + "rolled-share", o.rolled_share,
                 {"", 0.0, 1.0, "Share of cameras in hands and on their sides, rolled up to rolled-max instead."});
  visitor.option(prefix + "rolled-max", o.rolled_max_deg,
                 {"deg", 0.0, 180.0, "Greatest tilt of those to either side; 90: on its side."});
  visitor.option(prefix + "aim-error", o.aim_error_deg,
                 {"deg", 0.0, 90.0, "Standard deviation of the tilt about the one that aims at the first person."});
  visitor.option(prefix + "distance-min", o.distance_min_m, {"m", 0.3, 20.0, "Nearest person."});
  visitor.option(prefix + "distance-max", o.distance_max_m, {"m", 0.3, 20.0, "Farthest person."});
  visitor.option(prefix + "usual-min", o.usual_min_m, {"m", 0.3, 20.0, "Near end of where most people are."});
  visitor.option(prefix + "usual-max", o.usual_max_m, {"m", 0.3, 20.0, "Far end of where most people are."});
  visitor.option(prefix + "usual-share", o.usual_share, {"", 0.0, 1.0, "Share of people put there."});
}

void check(const CameraPlacement& options) {
  CameraPlacement copy = options;
  RangeCheck ranges;
  visit_options("camera.", copy, ranges);
  check_order("camera.height-min", options.height_min_m, "camera.height-max", options.height_max_m);
  check_order("camera.pitch-min", options.pitch_min_deg, "camera.pitch-max", options.pitch_max_deg);
  check_order("camera.distance-min", options.distance_min_m, "camera.distance-max", options.distance_max_m);
  check_order("camera.usual-min", options.usual_min_m, "camera.usual-max", options.usual_max_m);
}

Eigen::Isometry3f CameraPose::world_from_camera() const {
  Eigen::Matrix3f level;
  level << 1.F, 0.F, 0.F, 0.F, -1.F, 0.F, 0.F, 0.F, -1.F;
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear() = level * Eigen::AngleAxisf(-pitch_rad, Eigen::Vector3f::UnitX()).toRotationMatrix() *
                  Eigen::AngleAxisf(roll_rad, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  pose.translation().y() = height_m;
  return pose;
}

CameraPose sample_camera(const CameraPlacement& options, float target_height_m, float distance_m, Random& random) {
  CameraPose pose;
  pose.height_m = between(options.height_min_m, options.height_max_m, random);
  const float drop = std::clamp((pose.height_m - target_height_m) / std::max(distance_m, 0.1F), -1.F, 1.F);
  const float aim_deg = std::asin(drop) / kRadPerDeg + float(random.normal(0.0, options.aim_error_deg));
  pose.pitch_rad = std::clamp(aim_deg, options.pitch_min_deg, options.pitch_max_deg) * kRadPerDeg;
  pose.roll_rad = between(-options.roll_max_deg, options.roll_max_deg, random) * kRadPerDeg;
  if (options.rolled_share > 0.F && random.uniform() < options.rolled_share) {  // off: draws no random numbers
    pose.roll_rad = between(-options.rolled_max_deg, options.rolled_max_deg, random) * kRadPerDeg;
  }
  return pose;
}

float sample_distance(const CameraPlacement& options, Random& random) {
  const float low = std::max(options.usual_min_m, options.distance_min_m);
  const float high = std::min(options.usual_max_m, options.distance_max_m);
  const bool usual = random.uniform() < options.usual_share && low <= high;
  return usual ? between(low, high, random) : between(options.distance_min_m, options.distance_max_m, random);
}

}  // namespace vesalius::synth
