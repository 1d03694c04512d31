#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "capsule/capsule_person.h"
#include "vesalius/base/random.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

// Kinect v1: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking", 2012.
constexpr double kFocalPx = 580.0;
constexpr double kBaselineM = 0.075;
constexpr double kStepsPerPx = 8.0;  // disparity resolution
constexpr double kGrazing = 80.0 / 180.0 * std::numbers::pi;
constexpr int kEdgeMm = 100;  // depth step that counts as a silhouette
constexpr double kEdgeLoss = 0.5;
constexpr int kNearestMm = 400, kFurthestMm = 10000;
constexpr int kBorderShare = 80;

/// Returns the angle between the viewing ray and the surface's normal, from the two shorter depth steps beside the
/// pixel.
double incidence(const DepthImage& depth, const Camera& camera, int u, int v) {
  const int z = depth(u, v);
  const auto slope_mm = [&](int du, int dv) {
    int step = 0;
    int smallest = std::numeric_limits<int>::max();
    for (const int way : {-1, 1}) {
      if (!depth.contains(u + way * du, v + way * dv) || depth(u + way * du, v + way * dv) == 0) continue;
      const int change = way * (depth(u + way * du, v + way * dv) - z);
      if (std::abs(change) < smallest) smallest = std::abs(step = change);
    }
    return step;
  };
  const double fx = camera.fx, fy = camera.fy;
  const Eigen::Vector3d ray((u - static_cast<double>(camera.cx)) / fx, (v - static_cast<double>(camera.cy)) / fy, 1.0);
  const Eigen::Vector3d right = slope_mm(1, 0) * ray + Eigen::Vector3d(z / fx, 0.0, 0.0);
  const Eigen::Vector3d down = slope_mm(0, 1) * ray + Eigen::Vector3d(0.0, z / fy, 0.0);
  const double cosine = std::abs(right.cross(down).normalized().dot(ray.normalized()));
  return std::acos(std::min(1.0, cosine));
}

bool at_silhouette(const DepthImage& depth, int u, int v) {
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      if (!depth.contains(u + du, v + dv)) continue;
      const int read = depth(u + du, v + dv);
      if (read != 0 && std::abs(read - depth(u, v)) > kEdgeMm) return true;
    }
  }
  return false;
}

/// Returns which pixels of a row the projector, one baseline to the right, cannot reach.
std::vector<bool> shadow(const DepthImage& depth, const Camera& camera, int v) {
  std::vector<bool> dark(static_cast<std::size_t>(depth.width()), false);
  const double fb_mm = camera.fx * kBaselineM * 1000.0;
  double leftmost = std::numeric_limits<double>::infinity();  // column, in the projector's picture
  for (int u = depth.width() - 1; u >= 0; --u) {
    if (depth(u, v) == 0) continue;
    const double column = u - fb_mm / depth(u, v);
    dark[u] = column > leftmost;
    leftmost = std::min(leftmost, column);
  }
  return dark;
}

/// Returns a reading of the true surface at (u, v); 0 if the sensor gives none.
int sense(const Frame& truth, int u, int v, Random& random) {
  const DepthImage& depth = truth.depth;
  const double theta = incidence(depth, truth.camera, u, v);
  if (theta > kGrazing) return 0;
  const double angle = theta / (0.5 * std::numbers::pi - theta);
  const double lateral_px = (0.8 + 0.035 * angle) * truth.camera.fx / kFocalPx;
  const int su = static_cast<int>(std::lround(u + random.normal(0.0, lateral_px)));
  const int sv = static_cast<int>(std::lround(v + random.normal(0.0, lateral_px)));
  const int seen = depth.contains(su, sv) && depth(su, sv) != 0 ? depth(su, sv) : depth(u, v);
  const double z = seen / 1000.0;
  const double grazing = 0.0001 / std::sqrt(z) * angle * angle;
  const double axial_m = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4) + grazing;
  const double noisy = std::max(0.1, z + random.normal(0.0, axial_m));
  const double disparity = std::round(kFocalPx * kBaselineM / noisy * kStepsPerPx) / kStepsPerPx;
  const double mm = 1000.0 * kFocalPx * kBaselineM / disparity;
  return mm >= kNearestMm && mm <= kFurthestMm ? static_cast<int>(std::lround(mm)) : 0;
}

}  // namespace

void add_sensor_noise(Frame& frame, std::uint64_t seed) {
  check(frame);
  const Frame truth{frame.name, frame.time_s, frame.camera, frame.depth, {}};
  const int border = frame.depth.width() / kBorderShare;
  parallel_for(frame.depth.height(), [&](int v) {
    Random random(seed, static_cast<std::uint64_t>(v));
    const std::vector<bool> dark = shadow(truth.depth, truth.camera, v);
    for (int u = 0; u < frame.depth.width(); ++u) {
      if (truth.depth(u, v) == 0) continue;
      const bool lost = u < border || u >= frame.depth.width() - border || dark[u] ||
                        (at_silhouette(truth.depth, u, v) && random.uniform() < kEdgeLoss);
      frame.depth(u, v) = lost ? std::uint16_t{0} : static_cast<std::uint16_t>(sense(truth, u, v, random));
    }
  });
}

}  // namespace vesalius
