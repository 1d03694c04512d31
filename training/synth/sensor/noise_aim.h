#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "synth/sensor/camera_rays.h"
#include "synth/sensor/noise_field.h"
#include "synth/sensor/render.h"
#include "synth/sensor/sensor.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// The surfaces that the pixels of one row of a sensor read, as padded arrays for the formulas that follow
/// (noise_kernel.h).
struct AimedRow {
  Eigen::ArrayXf z;         ///< metres; 0: nothing
  Eigen::ArrayXf cosine;    ///< of the angle between ray and normal, kSmallestCosine to 1
  Eigen::ArrayXf infrared;  ///< share of light sent back
  Eigen::ArrayXf fall_off;  ///< fourth power of the cosine between ray and optical axis: share of light off the axis
  std::vector<std::uint32_t> source;  ///< pixel of the rendering, row-major
};

/// Finds the surface that each pixel of a sensor reads: jittered across the image plane, foreground grown over what is
/// behind it, shadows of projector and eye as holes, background thinned out along silhouettes, near and far mixed.
class Aim {
 public:
  /// Keeps references to all three.
  Aim(const Rendering& rendering, const Sensor& sensor, Random& random);

  /// Returns what row v reads. `losses` is normal noise that decides where the background is lost.
  const AimedRow& row(int v, const Eigen::ArrayXf& losses);

 private:
  struct Spot {
    int u = 0, v = 0;  ///< pixel of the rendering
    std::uint32_t at = 0;
    float z = 0.F;  ///< 0: no surface
    float cosine = 1.F;
  };

  Spot look(int u, int v) const;
  float amplitude(const Spot& spot) const { return in_.infrared[spot.at] * spot.cosine; }
  float slope_m(const Spot& spot, float distance_px) const;
  bool beyond_silhouette(const Spot& spot) const;
  Spot displaced(const Spot& spot) const;
  Spot grown(const Spot& spot) const;
  Spot at_silhouette(const Spot& spot, float loss);
  Spot across_silhouette(const Spot& spot) const;
  Spot mixed(const Spot& spot);

  const Rendering& in_;
  const Sensor& sensor_;
  Random& random_;
  int width_, height_;
  CameraRays rays_;
  int fatten_px_, reach_px_;
  float edge_threshold_;
  Image<float> seen_m_;  ///< depth of what light and eye both reach, 0 elsewhere
  Mask near_silhouette_;
  Image<float> nearest_m_;  ///< depth of the nearest surface within reach
  NoiseField shift_u_, shift_v_;
  AimedRow row_;
};

}  // namespace vesalius::synth
