#pragma once

#include <string>

#include "synth/sensor/resample_depth.h"
#include "synth/sensor/sensor.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// How far cameras, their rooms and what records them may differ from a preset. Each is drawn for every camera.
struct SensorVariety {
  float matching_max = 1.F;     ///< a stereo camera's matching errors grow by up to this factor
  float dim_max = 1.F;          ///< surfaces must send back up to this many times the light
  float flying_max = 1.F;       ///< time of flight: silhouettes are mixed up to this many times as wide
  float stray_light_max = 0.F;  ///< time of flight: largest share of the mean light that scatters into every pixel
  float multipath_max =
      0.F;                 ///< time of flight: greatest strength of light by way of other surfaces, see add_multipath()
  float border_max = 0.F;  ///< largest share of the sides that has no reading, at each border
  float focal_error = 0.F;  ///< largest error of the stated focal length, as a share of it
  ResamplingOptions resampled;
  friend bool operator==(const SensorVariety&, const SensorVariety&) = default;
};

void visit_options(const std::string& prefix, SensorVariety& options, OptionVisitor& visitor);

/// One camera as it was drawn.
struct VariedSensor {
  Sensor sensor;
  float stray_light = 0.F;       ///< see add_stray_light()
  float multipath = 0.F;         ///< see add_multipath()
  float true_focal_share = 1.F;  ///< the true focal length as a share of the stated one
  Resampling resampling;
};

/// Draws a camera. Factors are even in their logarithm, shares and errors even; every second border stays as it is.
VariedSensor draw_sensor(const SensorVariety& options, const Sensor& sensor, Random random);

}  // namespace vesalius::synth
