#include "synth/sensor/sensor_variety.h"

#include <array>
#include <cmath>

namespace vesalius::synth {
namespace {

/// Draws a factor from 1 to `most`, evenly in its logarithm.
float draw_factor(float most, Random& random) { return float(std::pow(most, random.uniform())); }

/// Widens the borders without readings. The same numbers are drawn whatever `most` is.
void widen_borders(float most, Sensor& sensor, Random& random) {
  const auto draw = [&](int side) {
    const double share = random.uniform(), wide = random.uniform();
    return share < 0.5 ? 0 : int(std::lround(wide * most * float(side)));
  };
  const Camera& camera = sensor.camera;
  const Border more{draw(camera.width), draw(camera.width), draw(camera.height), draw(camera.height)};
  for (Border* border : {&sensor.border_low, &sensor.border_high}) {
    border->left += more.left;
    border->right += more.right;
    border->top += more.top;
    border->bottom += more.bottom;
  }
}

}  // namespace

void visit_options(const std::string& prefix, SensorVariety& o, OptionVisitor& visitor) {
  visitor.option(
      prefix + "matching-max", o.matching_max,
      {"", 1, 100, "Greatest factor by which plain, dim or shiny rooms make a stereo camera's errors larger."});
  visitor.option(prefix + "dim-max", o.dim_max,
                 {"", 1, 100,
                  "Greatest factor by which surfaces must be brighter to be read: weak light, sunshine, old cameras. "
                  "Dark cloth, hair and sofas lose their depth."});
  visitor.option(prefix + "flying-max", o.flying_max,
                 {"", 1, 20, "Greatest factor by which the flying pixels of time of flight reach farther."});
  visitor.option(prefix + "stray-light-max", o.stray_light_max,
                 {"", 0, 1, "Time of flight: greatest share of other surfaces' light in every reading."});
  visitor.option(prefix + "multipath-max", o.multipath_max,
                 {"", 0, 10,
                  "Time of flight: greatest strength of the light that comes by way of a second surface; 1: as matt "
                  "surfaces of the rendered brightness send it."});
  visitor.option(prefix + "border-max", o.border_max,
                 {"", 0, 0.4, "Greatest share of width and height without readings at a border."});
  visitor.option(prefix + "focal-error", o.focal_error,
                 {"", 0, 0.2, "Greatest error of the focal length that comes with the frames, as a share of it."});
  visit_options(prefix + "resampled.", o.resampled, visitor);
}

VariedSensor draw_sensor(const SensorVariety& options, const Sensor& sensor, Random random) {
  VariedSensor drawn{.sensor = sensor, .stray_light = 0.F, .multipath = 0.F, .true_focal_share = 1.F, .resampling = {}};
  drawn.sensor.matching_px *= draw_factor(options.matching_max, random);
  drawn.sensor.min_infrared *= draw_factor(options.dim_max, random);
  drawn.sensor.mixed_px *= draw_factor(options.flying_max, random);
  drawn.stray_light = options.stray_light_max * float(random.uniform());
  drawn.true_focal_share = 1.F + options.focal_error * float(random.uniform(-1.0, 1.0));
  widen_borders(options.border_max, drawn.sensor, random);
  drawn.resampling = draw_resampling(options.resampled, random);
  drawn.multipath = options.multipath_max * float(random.uniform());
  return drawn;
}

}  // namespace vesalius::synth
