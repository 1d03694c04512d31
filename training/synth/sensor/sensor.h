#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/camera.h"

namespace vesalius::synth {

/// The measuring principle of a depth camera, which determines its errors.
enum class SensorKind : std::uint8_t {
  perfect,           ///< no noise, for tests
  structured_light,  ///< Kinect v1, Xtion
  stereo,            ///< RealSense D400
  time_of_flight     ///< Kinect v2, Azure Kinect, Femto
};

/// Columns and rows at the picture's borders that have no reading.
struct Border {
  int left = 0, right = 0, top = 0, bottom = 0;
  friend bool operator==(const Border&, const Border&) = default;
};

/// A depth camera: nominal intrinsics and the parameters of its noise. sensor.cpp names their sources. Numbers in
/// pixels refer to the size of `camera`.
struct Sensor {
  std::string name;  ///< such as "kinect-v1"
  SensorKind kind = SensorKind::perfect;
  Camera camera;  ///< camera of the depth picture
  float near_m = 0.4F, far_m = 10.F;

  float baseline_m = 0.F;         ///< x of the projector or second eye, camera frame (negative: to the left)
  float eye_m = 0.F;              ///< x of the measuring eye; not 0 if depth is warped onto another camera
  float disparity_px_m = 0.F;     ///< disparity times depth: native focal length times distance of eye and projector
  float disparity_step_px = 0.F;  ///< native pixels; 0 if disparities are not quantised

  float axial_base_m = 0.F, axial_z2 = 0.F, axial_z0_m = 0.F;  ///< error's sigma = base + z2 (z - z0)^2, metres
  float amplitude_z2 = 0.F;  ///< time of flight: sigma grows by this * z^2 / (infrared * cos of the angle), 1/metres
  float matching_px = 0.F;   ///< stereo: RMS error of the disparity, native pixels
  float lateral_px = 0.F;    ///< standard deviation of the position that a pixel reads
  float window_px = 1.F;     ///< width over which errors and holes are correlated
  float fatten_px = 0.F;     ///< width by which the near side of a silhouette grows
  float mixed_px = 0.F;      ///< width of the zone at a silhouette that reads a mixture of near and far

  float max_angle_rad = 1.57F;     ///< angle between ray and normal at which half of the readings are lost
  float min_infrared = 0.F;        ///< reflectance at which half of the readings of a facing surface at 2 m are lost
  float edge_px = 0.F;             ///< width of the zone beside a silhouette in which the background has holes
  float edge_loss = 0.F;           ///< share of that zone without a reading, 0-1
  float mixed_loss = 0.F;          ///< share of mixed readings that the driver removes, 0-1
  Border border_low, border_high;  ///< each frame's border lies between these
};

/// These return all presets, and the preset of a name. The latter throws UsageError listing the names for any other
/// word.
const std::vector<Sensor>& sensors();
const Sensor& find_sensor(std::string_view name);

/// Returns the sensor with another camera. Quantities in pixels scale with the focal length. Throws Error for an
/// invalid camera.
Sensor with_camera(const Sensor& sensor, const Camera& camera);

/// Returns the sensor binned to another width, with rows cut off or added equally above and below. It is the starting
/// point for custom intrinsics. Throws UsageError unless both sides are 16 to 8192.
Sensor reframed(const Sensor& sensor, int width, int height);

/// Returns the sensor binned to another width and cropped to `height` around the middle row. Focal length and
/// quantities in pixels scale with the width. Throws UsageError unless both are 16 to 8192 and the height is at most
/// that of the binned picture.
Sensor resized(const Sensor& sensor, int width, int height);

}  // namespace vesalius::synth
