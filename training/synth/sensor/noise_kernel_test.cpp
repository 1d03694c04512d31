#include "synth/sensor/noise_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius::synth {
namespace {

constexpr double kHalfPi = 1.5707963267948966;

/// Arrays as the kernels require them: `width` values, then padding.
struct Row {
  std::vector<float> z, cosine, infrared, fall_off, loss, error;

  Row(Random& random, int width) {
    for (std::vector<float>* all : {&z, &cosine, &infrared, &fall_off, &loss, &error}) {
      all->resize(static_cast<std::size_t>(padded_width(width)));
    }
    const auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
    for (std::size_t i = 0; i < static_cast<std::size_t>(width); ++i) {
      z[i] = random.below(10) == 0 ? 0.F : number(0.2, 12.0);
      cosine[i] = number(0.02, 1.0);
      infrared[i] = random.below(10) == 0 ? 0.F : number(0.01, 1.0);
      fall_off[i] = number(0.5, 1.0);
      loss[i] = number(-3.5, 3.5);
      error[i] = number(-3.5, 3.5);
    }
  }
  NoisyRow view() const {
    return {z.data(), cosine.data(), infrared.data(), fall_off.data(), loss.data(), error.data()};
  }
};

struct Expected {
  double z_m = 0.0;        ///< measured depth if there is a reading
  double clearance = 0.0;  ///< distance of the loss noise from the opposite decision
};

/// Computes the formulas of the sensors in doubles with the library's functions.
Expected plainly(const Sensor& s, const Row& row, std::size_t i) {
  const double z = row.z[i], error = row.error[i], angle = std::acos(static_cast<double>(row.cosine[i]));
  const double signal = static_cast<double>(row.infrared[i]) * row.cosine[i] * row.fall_off[i];
  const double doublings = std::log2(signal * 4.0 / (z * z) / s.min_infrared);
  const double kept = std::min(1.2 * doublings, (s.max_angle_rad - angle) / 0.052);
  const double axial = s.axial_base_m + s.axial_z2 * std::pow(z - s.axial_z0_m, 2.0);
  const auto quantised = [&](double px) {
    return s.disparity_px_m / (std::floor(px / s.disparity_step_px + 0.5) * s.disparity_step_px);
  };
  Expected out{0.0, kept - row.loss[i]};
  if (s.kind == SensorKind::structured_light) {
    const double limited = std::min(angle, 1.55), t = limited / (kHalfPi - limited);
    const double sigma = axial + 0.0001 / std::sqrt(z) * t * t;
    const double step = z * z * s.disparity_step_px / s.disparity_px_m;
    const double before = std::sqrt(std::max(0.0, sigma * sigma - step * step / 12.0));
    out.z_m = quantised(s.disparity_px_m / std::max(0.1, z + before * error));
  } else if (s.kind == SensorKind::stereo) {
    out.z_m = quantised(s.disparity_px_m / z + s.matching_px * error);
  } else {
    out.z_m = z + (axial + s.amplitude_z2 * z * z / std::max(signal, 1e-4)) * error;
  }
  return out;
}

/// Returns the distance to the next value of a sensor with quantised values.
double step_m(const Sensor& s, double z) {
  return s.disparity_px_m > 0.F ? z * z * s.disparity_step_px / s.disparity_px_m : 0.0;
}

void expect_formulas(const Sensor& sensor, const Row& row, int width, const std::vector<std::uint16_t>& read_mm) {
  int readings = 0, holes = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(width); ++i) {
    if (row.z[i] == 0.F) {
      EXPECT_EQ(read_mm[i], 0);
      continue;
    }
    const Expected expected = plainly(sensor, row, i);
    if (std::abs(expected.clearance) < 0.01) continue;  // the angle is rounded
    const bool in_range = expected.z_m >= sensor.near_m && expected.z_m <= sensor.far_m;
    const double tolerance_m = 1.05 * step_m(sensor, expected.z_m) + 0.0005 + 0.002 * std::abs(expected.z_m);
    const bool at_limit =
        std::abs(expected.z_m - sensor.near_m) < tolerance_m || std::abs(expected.z_m - sensor.far_m) < tolerance_m;
    if (at_limit) continue;
    if (expected.clearance < 0.0 || !in_range) {
      ++holes;
      EXPECT_EQ(read_mm[i], 0) << sensor.name << ' ' << row.z[i];
    } else {
      ++readings;
      EXPECT_NEAR(read_mm[i] * 0.001, expected.z_m, tolerance_m) << sensor.name << ' ' << row.z[i];
    }
  }
  EXPECT_GT(readings, width / 10) << sensor.name;
  EXPECT_GT(holes, width / 10) << sensor.name;
}

TEST(NoiseKernel, ReadsByTheFormulasOnEveryInstructionSet) {
  for (const Sensor& sensor : sensors()) {
    if (sensor.kind == SensorKind::perfect) continue;
    Random random(7);
    constexpr int kWidth = 1003;
    const Row row(random, kWidth);
    std::vector<std::uint16_t> first;
    for_each_target([&](const char* target) {
      std::vector<std::uint16_t> read_mm(static_cast<std::size_t>(padded_width(kWidth)), 77);
      read_row(sensor, row.view(), kWidth, read_mm.data());
      read_mm.resize(kWidth);
      if (first.empty()) first = read_mm;
      EXPECT_EQ(read_mm, first) << sensor.name << ' ' << target;
    });
    expect_formulas(sensor, row, kWidth, first);
  }
}

TEST(NoiseKernel, ComputesAnglesByTheFormulasOnEveryInstructionSet) {
  Random random(8);
  for (const int width : {1, 15, 16, 77}) {
    const auto count = static_cast<std::size_t>(width);
    std::vector<Eigen::Vector3f> normals(count);
    std::vector<float> x(count);  // without padding, because nothing beyond may be read
    for (std::size_t i = 0; i < count; ++i) {
      normals[i] = Eigen::Vector3f(static_cast<float>(random.normal()), static_cast<float>(random.normal()), -1.F);
      normals[i].normalize();
      x[i] = static_cast<float>(random.uniform(-0.6, 0.6));
    }
    constexpr float kY = 0.3F;
    std::vector<float> first_cosine, first_fall_off;
    for_each_target([&](const char* target) {
      std::vector<float> cosine(static_cast<std::size_t>(padded_width(width))), fall_off(cosine.size());
      face_row(normals.data(), x.data(), kY, width, cosine.data(), fall_off.data());
      cosine.resize(count);
      fall_off.resize(count);
      if (first_cosine.empty()) first_cosine = cosine, first_fall_off = fall_off;
      EXPECT_EQ(cosine, first_cosine) << target << ' ' << width;
      EXPECT_EQ(fall_off, first_fall_off) << target << ' ' << width;
    });
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f ray = Eigen::Vector3f(x[i], kY, 1.F).normalized();
      EXPECT_NEAR(first_cosine[i], std::clamp(-ray.dot(normals[i]), kSmallestCosine, 1.F), 1e-6F);
      EXPECT_NEAR(first_fall_off[i], std::pow(ray.z(), 4.F), 1e-6F);
    }
  }
}

}  // namespace
}  // namespace vesalius::synth
