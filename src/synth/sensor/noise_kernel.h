#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "synth/sensor/sensor.h"

// The noise of one row of a picture, on vectors: every target gives the same bits, for each step is an operation that
// IEEE 754 rounds in one way.
namespace vesalius::synth {

/// Floats that these functions may read and write past the end of an array of theirs.
constexpr std::size_t kNoiseLanes = 16;

/// Length of an array for `width` pixels.
constexpr Eigen::Index padded_width(int width) {
  return static_cast<Eigen::Index>((static_cast<std::size_t>(width) + kNoiseLanes - 1) / kNoiseLanes * kNoiseLanes);
}

constexpr float kSmallestCosine = 0.02F;
/// Angle (rad) of a cosine c in [0, 1] = sqrt(1 - c) times the polynomial with these coefficients, lowest first:
/// Abramowitz and Stegun 4.4.45, error below 7e-5.
constexpr std::array<float, 4> kAngleSeries{1.5707288F, -0.2121144F, 0.0742610F, -0.0187293F};

/// Cosine of the angle between each ray (x, y, 1) and its unit normal, kSmallestCosine to 1, and the fourth power of
/// that between ray and optical axis. The outputs are padded.
void face_row(const Eigen::Vector3f* normals, const float* ray_x, float ray_y, int width, float* cosine,
              float* fall_off);

/// The surfaces that the pixels of a row aim at, and the normal noise that they meet. All arrays are padded.
struct NoisyRow {
  const float* z;         ///< metres; 0: nothing
  const float* cosine;    ///< of the angle between ray and normal
  const float* infrared;  ///< share of light sent back
  const float* fall_off;  ///< share of light off the optical axis
  const float* loss;      ///< decides whether there is a reading
  const float* error;     ///< of the depth
};

/// Computes what a sensor with noise (any kind but `perfect`) reads, in mm; 0 is no reading. `depth_mm` is padded.
void read_row(const Sensor& sensor, const NoisyRow& row, int width, std::uint16_t* depth_mm);

}  // namespace vesalius::synth
