#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/base/camera.h"

namespace vesalius::synth {

/// How a depth camera measures, which decides its errors.
enum class SensorKind : std::uint8_t {
  perfect,           ///< no noise, for tests
  structured_light,  ///< Kinect v1, Xtion
  stereo,            ///< RealSense D400
  time_of_flight     ///< Kinect v2, Azure Kinect, Femto
};

/// Columns and rows beside the picture's borders that have no reading.
struct Border {
  int left = 0, right = 0, top = 0, bottom = 0;
  friend bool operator==(const Border&, const Border&) = default;
};

/// A depth camera: nominal intrinsics and the numbers of its noise. Sources stand in sensor.cpp. Numbers in pixels are
/// for the size of `camera`.
struct Sensor {
  std::string name;   ///< "kinect-v1"
  std::string title;  ///< "Microsoft Kinect for Xbox 360"
  SensorKind kind = SensorKind::perfect;
  Camera camera;  ///< of the depth picture
  float near_m = 0.4F, far_m = 10.F;

  float baseline_m = 0.F;         ///< x of the projector or second eye, camera frame (negative: to the left)
  float eye_m = 0.F;              ///< x of the eye that measures; not 0 where depth is warped onto another camera
  float disparity_px_m = 0.F;     ///< disparity x depth: native focal length x distance of eye and projector
  float disparity_step_px = 0.F;  ///< native pixels; 0: not quantised

  float axial_base_m = 0.F, axial_z2 = 0.F, axial_z0_m = 0.F;  ///< sigma = base + z2 (z - z0)^2, metres
  float amplitude_z2 = 0.F;  ///< time of flight: sigma += this x z^2 / (infrared x cos of the angle), 1/metres
  float matching_px = 0.F;   ///< stereo: RMS error of the disparity, native pixels
  float lateral_px = 0.F;    ///< standard deviation of where a pixel reads
  float window_px = 1.F;     ///< width over which errors and holes hang together
  float fatten_px = 0.F;     ///< how far the near side of a silhouette grows
  float mixed_px = 0.F;      ///< width of the zone at a silhouette that reads a mixture of near and far

  float max_angle_rad = 1.57F;     ///< between ray and normal, where half of the readings are lost
  float min_infrared = 0.F;        ///< reflectance at which half of the readings are lost, at 2 m, facing the camera
  float edge_px = 0.F;             ///< how far beyond a silhouette the background thins out
  float edge_loss = 0.F;           ///< share of that zone without a reading, 0-1
  float mixed_loss = 0.F;          ///< share of mixed readings that the driver removes, 0-1
  Border border_low, border_high;  ///< each frame's border lies between these
};

/// All presets, and the one of a name; throws UsageError listing the names for another.
const std::vector<Sensor>& sensors();
const Sensor& find_sensor(std::string_view name);

/// The sensor behind another camera: pixel quantities scale with the focal length. Throws Error for a camera that
/// cannot be.
Sensor with_camera(const Sensor& sensor, const Camera& camera);

/// The sensor binned to another width, with rows cut off or added above and below alike: what intrinsics of one's own
/// start from. Throws UsageError unless both sides are 16 to 8192.
Sensor reframed(const Sensor& sensor, int width, int height);

/// The sensor binned to another width and cropped to `height` around the middle row: focal length and pixel quantities
/// scale with the width. Throws UsageError unless both are 16 to 8192 and the height is at most that of the binned
/// picture.
Sensor resized(const Sensor& sensor, int width, int height);

}  // namespace vesalius::synth
