#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "synth/sensor/sensor.h"

// Computes the noise of one row of a picture on vectors. Every instruction set gives the same bits, because every step
// is an operation that IEEE 754 rounds in exactly one way.
namespace vesalius::synth {

/// Number of floats past the end of an array that these functions may read and write.
constexpr std::size_t kNoiseLanes = 16;

/// Returns the length of an array for `width` pixels.
constexpr Eigen::Index padded_width(int width) {
  return static_cast<Eigen::Index>((static_cast<std::size_t>(width) + kNoiseLanes - 1) / kNoiseLanes * kNoiseLanes);
}

constexpr float kSmallestCosine = 0.02F;
/// The angle (rad) of a cosine c in [0, 1] is sqrt(1 - c) times the polynomial with these coefficients, lowest first
/// (Abramowitz and Stegun 4.4.45, error below 7e-5).
constexpr std::array<float, 4> kAngleSeries{1.5707288F, -0.2121144F, 0.0742610F, -0.0187293F};

/// Computes the cosine of the angle between each ray (x, y, 1) and its unit normal, from kSmallestCosine to 1, and the
/// fourth power of the cosine between ray and optical axis. The outputs are padded.
void face_row(const Eigen::Vector3f* normals, const float* ray_x, float ray_y, int width, float* cosine,
              float* fall_off);

/// The surfaces at which the pixels of a row aim, and the normal noise of their readings. All arrays are padded.
struct NoisyRow {
  const float* z;         ///< metres; 0 means that there is no surface
  const float* cosine;    ///< cosine of the angle between ray and normal
  const float* infrared;  ///< share of reflected light
  const float* fall_off;  ///< share of light that remains off the optical axis
  const float* loss;      ///< noise that decides whether there is a reading
  const float* error;     ///< noise of the depth
};

/// Computes the readings of a sensor with noise (any kind but `perfect`) in mm; 0 means no reading. `depth_mm` is
/// padded.
void read_row(const Sensor& sensor, const NoisyRow& row, int width, std::uint16_t* depth_mm);

}  // namespace vesalius::synth
