#include "synth/sensor/multipath.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr int kColumns = 32;
constexpr float kPeriod_m = 1.5F;       ///< of the distance, at 100 MHz
constexpr float kLeastFacing = 0.05F;   ///< cosine to the camera: what is seen more sideways counts as this
constexpr float kSameSurface_m = 0.3F;  ///< how far a patch may lie from a pixel that takes over its error

/// What the middle pixel of a square of pixels sees, or of what the border leaves of one.
struct Patch {
  Vector3f at = Vector3f::Zero(), normal = Vector3f::Zero();
  float range_m = 0.F;  ///< from the camera; 0: nothing is seen
  float gives = 0.F;    ///< light that it sends on, by all that the camera sends into one steradian
  float side_m = 0.F;   ///< of the square at this distance
  float error_m = 0.F;  ///< how much farther it seems
};

/// Returns sin(2 pi x) for x of 0 to 1, to 0.001. The library's function may give other bits on another machine.
float sine_of_turn(float x) {
  const float t = x < 0.5F ? x : x - 1.F;
  const float parabola = 8.F * t * (1.F - 2.F * std::abs(t));
  return parabola + 0.225F * parabola * (std::abs(parabola) - 1.F);
}

float cosine_of_turn(float x) { return sine_of_turn(x < 0.75F ? x + 0.25F : x - 0.75F); }

/// Returns the angle of a direction from the first axis towards the second, in turns; within 0.001.
float turn_of(float along, float across) {
  const float low = std::min(std::abs(along), std::abs(across)), high = std::max(std::abs(along), std::abs(across));
  if (high <= 0.F) return 0.F;
  const float slope = low / high;
  float turn = slope / (1.F + 0.28F * slope * slope) / (2.F * std::numbers::pi_v<float>);
  if (std::abs(across) > std::abs(along)) turn = 0.25F - turn;
  if (along < 0.F) turn = 0.5F - turn;
  return std::copysign(turn, across);
}

class Multipath {
 public:
  Multipath(float strength, const Rendering& rendering)
      : r_(rendering),
        step_(std::max(1, rendering.depth_m.width() / kColumns)),
        patches_((rendering.depth_m.width() + step_ - 1) / step_, (rendering.depth_m.height() + step_ - 1) / step_) {
    for (int j = 0; j < patches_.height(); ++j) {
      for (int i = 0; i < patches_.width(); ++i) patches_(i, j) = patch_at(strength, i, j);
    }
    for (Patch& patch : patches_) {
      if (patch.range_m > 0.F) patch.error_m = error_of(patch);
    }
  }

  /// Returns how much farther a pixel seems along its ray: as the patches around it in space, the nearest
  /// ones most.
  float error_at(int u, int v, const Vector3f& point) const {
    const int i = u / step_, j = v / step_;
    float weights = 0.F, sum = 0.F;
    for (int y = std::max(0, j - 1); y <= std::min(patches_.height() - 1, j + 1); ++y) {
      for (int x = std::max(0, i - 1); x <= std::min(patches_.width() - 1, i + 1); ++x) {
        const Patch& patch = patches_(x, y);
        if (patch.range_m == 0.F) continue;
        const float apart = (patch.at - point).norm();
        if (apart > kSameSurface_m) continue;
        const float near = 1.F - apart / kSameSurface_m;
        const float weight = near * near * near;
        weights += weight;
        sum += weight * patch.error_m;
      }
    }
    return weights > 0.F ? sum / weights : 0.F;
  }

 private:
  Patch patch_at(float strength, int i, int j) const {
    const int width = std::min(step_, r_.depth_m.width() - i * step_);
    const int height = std::min(step_, r_.depth_m.height() - j * step_);
    const int u = i * step_ + width / 2, v = j * step_ + height / 2;
    const float z = r_.depth_m(u, v);
    if (z <= 0.F) return {};
    const Camera& camera = r_.view.camera;
    Patch patch{.at = camera.point(float(u), float(v), z), .normal = r_.normal(u, v)};
    patch.range_m = patch.at.norm();
    patch.side_m = float(step_) * z / camera.fx;
    const float cosine = z / patch.range_m;
    const float steradians = float(width * height) * cosine * cosine * cosine / (camera.fx * camera.fy);
    patch.gives = strength * r_.infrared(u, v) * steradians / std::numbers::pi_v<float>;
    return patch;
  }

  /// Adds up the light that all other patches send here, by its phase against the light that comes straight.
  float error_of(const Patch& to) const {
    float along = 0.F, across = 0.F;
    for (const Patch& from : patches_) {
      if (from.range_m == 0.F || &from == &to) continue;
      const Vector3f way = to.at - from.at;
      const float squared = std::max(way.squaredNorm(), from.side_m * from.side_m), distance = std::sqrt(squared);
      const float leaves = from.normal.dot(way), arrives = -to.normal.dot(way);
      if (leaves <= 0.F || arrives <= 0.F) continue;
      const float light = from.gives * leaves * arrives / (squared * squared);
      const float longer = std::max(0.F, 0.5F * (from.range_m + distance - to.range_m)) / kPeriod_m;
      const float turns = longer - std::floor(longer);
      along += light * cosine_of_turn(turns);
      across += light * sine_of_turn(turns);
    }
    const float facing = std::max(kLeastFacing, -to.normal.dot(to.at) / to.range_m);
    const float straight = facing / (to.range_m * to.range_m);
    return turn_of(straight + along, across) * kPeriod_m;
  }

  const Rendering& r_;
  int step_;
  Image<Patch> patches_;
};

}  // namespace

void add_multipath(float strength, Rendering& rendering) {
  if (strength <= 0.F) return;
  const Multipath multipath(strength, rendering);
  const Camera& camera = rendering.view.camera;
  for (int v = 0; v < rendering.depth_m.height(); ++v) {
    for (int u = 0; u < rendering.depth_m.width(); ++u) {
      float& z = rendering.depth_m(u, v);
      if (z <= 0.F) continue;
      const Vector3f point = camera.point(float(u), float(v), z);
      z += multipath.error_at(u, v, point) * z / point.norm();
    }
  }
}

}  // namespace vesalius::synth
