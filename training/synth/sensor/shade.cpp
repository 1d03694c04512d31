#include "synth/sensor/shade.h"

#include <algorithm>
#include <cmath>

namespace vesalius::synth {
namespace {

/// Returns the number of the cell along one axis. The odd shift keeps rounding from tearing cells, since surfaces are
/// often at round coordinates.
std::int64_t cell(float at, float period_m) {
  constexpr double kShift = 0.3719;
  return static_cast<std::int64_t>(std::floor(double(at) / double(period_m) + kShift));
}

/// Returns 0-255, the same within a cell.
std::uint32_t speckle(const Eigen::Vector3f& point, float period_m) {
  std::uint32_t hash = 2166136261U;
  for (int axis = 0; axis < 3; ++axis) {
    hash = (hash ^ static_cast<std::uint32_t>(cell(point[axis], period_m))) * 16777619U;
  }
  hash ^= hash >> 15U;
  return (hash * 2246822519U) >> 24U;
}

Rgb mixed(Rgb a, Rgb b, std::uint32_t share) {
  const auto mix = [&](std::uint8_t x, std::uint8_t y) {
    return static_cast<std::uint8_t>((x * (255U - share) + y * share + 127U) / 255U);
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

}  // namespace

Rgb colour_at(const Material& material, const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
  const float period_m = std::max(material.period_m, 1e-3F);
  switch (material.texture) {
    case Texture::plain:
      break;
    case Texture::stripes: {
      const float at = std::abs(normal.y()) > 0.7F ? point.x() : point.y();
      return (cell(at, period_m) & 1) != 0 ? material.second : material.colour;
    }
    case Texture::checks: {
      const std::int64_t sum = cell(point.x(), period_m) + cell(point.y(), period_m) + cell(point.z(), period_m);
      return (sum & 1) != 0 ? material.second : material.colour;
    }
    case Texture::speckle:
      return mixed(material.colour, material.second, speckle(point, period_m));
  }
  return material.colour;
}

float brightness(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, const std::vector<Light>& lights,
                 float ambient) {
  constexpr float kNearestSquared = 0.09F;  // a lamp is not a point: distances count as at least 0.3 m
  float sum = ambient;
  for (const Light& light : lights) {
    const Eigen::Vector3f way = light.position - point;
    const float squared = std::max(way.squaredNorm(), kNearestSquared);
    const float facing = normal.dot(way);
    if (facing > 0.F) sum += light.strength * facing / (squared * std::sqrt(squared));
  }
  return sum;
}

Rgb lit(Rgb colour, float brightness) {
  const auto scaled = [&](std::uint8_t c) {
    return static_cast<std::uint8_t>(std::clamp(float(c) * brightness + 0.5F, 0.F, 255.F));
  };
  return {scaled(colour.r), scaled(colour.g), scaled(colour.b)};
}

}  // namespace vesalius::synth
