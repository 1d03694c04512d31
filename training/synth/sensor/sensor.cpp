#include "synth/sensor/sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr int kSmallest = 16, kLargest = 8192;
constexpr float kDegree = 3.14159265F / 180.F;

/// Returns PrimeSense's structured light as in Kinect v1 and Xtion, with depth warped onto the colour camera as OpenNI
/// does. Axial and lateral noise: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction
/// and Tracking", 2012. Projector, colour camera and infrared eye are in this order, 50 and 25 mm apart. Disparities
/// have steps of 1/8 pixel at f = 580 px: Khoshelham, Oude Elberink, "Accuracy and Resolution of Kinect Depth Data",
/// 2012. Window, fattening, edges, borders and dark limit are tuned to public frames of eight Kinects and Xtions:
/// silhouette holes are 4 px narrower than the shadow, a third of silhouettes have a hole of 6 to 14 px even without a
/// shadow, and borders have 0-43, 7-35, 0-34 and 0-16 px.
Sensor registered_kinect() {
  Sensor s;
  s.name = "kinect-v1";
  s.kind = SensorKind::structured_light;
  s.camera = {640, 480, 525.F, 525.F, 319.5F, 239.5F};  // OpenNI's defaults
  s.near_m = 0.45F;
  s.far_m = 9.8F;
  s.baseline_m = 0.05F;
  s.eye_m = -0.025F;
  s.disparity_px_m = 580.F * 0.075F;
  s.disparity_step_px = 0.125F;
  s.axial_base_m = 0.0012F;
  s.axial_z2 = 0.0019F;
  s.axial_z0_m = 0.4F;
  s.lateral_px = 0.8F;
  s.window_px = 7.F;
  s.fatten_px = 2.F;
  s.max_angle_rad = 84.F * kDegree;
  s.min_infrared = 0.01F;
  s.edge_px = 6.F;
  s.edge_loss = 0.2F;
  s.border_low = {0, 7, 0, 0};
  s.border_high = {43, 35, 34, 16};
  return s;
}

/// Returns the infrared camera's own picture. f comes from the 7-Scenes and Khoshelham calibrations; its last 8 columns
/// are empty.
Sensor raw_kinect() {
  Sensor s = registered_kinect();
  s.name = "kinect-v1-raw";
  s.camera = {640, 480, 580.F, 580.F, 319.5F, 239.5F};
  s.baseline_m = 0.075F;
  s.eye_m = 0.F;
  s.border_low = s.border_high = {0, 8, 0, 0};
  return s;
}

/// Returns Asus' Xtion PRO Live, the same PrimeSense module at OpenNI's nominal f = 570.3 px for the infrared eye.
Sensor xtion() {
  Sensor s = registered_kinect();
  s.name = "xtion";
  s.disparity_px_m = 570.3F * 0.075F;
  return s;
}

Sensor time_of_flight(const char* name, const Camera& camera) {
  Sensor s;
  s.name = name;
  s.kind = SensorKind::time_of_flight;
  s.camera = camera;
  s.near_m = 0.5F;
  s.mixed_px = 1.F;
  s.mixed_loss = 0.5F;  // the drivers' filters remove about every other mixed pixel
  s.window_px = 3.F;
  s.max_angle_rad = 85.F * kDegree;
  return s;
}

/// Returns Kinect v2. f and centre: common calibrations (libfreenect2). Range and noise: Wasenmüller, Stricker,
/// "Comparison of Kinect v1 and v2 Depth Images in Terms of Accuracy and Precision", 2016: 1 mm near, some 3 mm at 4 m
/// on a bright wall.
Sensor kinect_v2() {
  Sensor s = time_of_flight("kinect-v2", {512, 424, 365.456F, 365.456F, 254.878F, 205.395F});
  s.far_m = 8.F;
  s.axial_base_m = 0.001F;
  s.amplitude_z2 = 0.0001F;
  s.min_infrared = 0.008F;
  return s;
}

/// Returns the narrow unbinned mode of an Azure Kinect or a Femto Bolt. The range comes from Microsoft's hardware
/// specification, which bounds the random error by 17 mm; the noise has half of Kinect v2's slope: Kurillo et al.,
/// "Evaluating the Accuracy of the Azure Kinect and Kinect v2", 2022.
Sensor azure_kinect(const char* name) {
  Sensor s = time_of_flight(name, {640, 576, 504.F, 504.F, 320.F, 330.F});
  s.far_m = 5.46F;  // 3.86 m is specified; bright surfaces are seen up to the end of the phase's period
  s.axial_base_m = 0.0007F;
  s.amplitude_z2 = 0.00005F;
  s.min_infrared = 0.01F;
  return s;
}

/// Returns a RealSense. Baselines, nearest depth and the best resolution of 848x480: Intel, "D400 Series datasheet".
/// Noise: RMS = z^2 s / (f B) of Intel's tuning guide (Grunnet-Jepsen et al., "Best-known methods for tuning D400 depth
/// cameras", 2018), with 5 fractional bits of disparity.
Sensor realsense(const char* name, float baseline_m, float nearest_m) {
  Sensor s;
  s.name = name;
  s.kind = SensorKind::stereo;
  s.camera = {848, 480, 424.F, 424.F, 423.5F, 239.5F};
  s.near_m = nearest_m;
  s.far_m = 10.F;
  s.baseline_m = baseline_m;
  s.disparity_px_m = s.camera.fx * baseline_m;
  s.disparity_step_px = 1.F / 32.F;
  s.matching_px = 0.08F;
  s.window_px = 7.F;
  s.fatten_px = 3.F;
  s.lateral_px = 0.5F;
  s.max_angle_rad = 82.F * kDegree;
  s.min_infrared = 0.01F;
  s.edge_px = 4.F;
  s.edge_loss = 0.2F;
  return s;
}

/// Returns a camera without noise, for tests.
Sensor perfect() {
  Sensor s;
  s.name = "perfect";
  s.camera = {640, 480, 525.F, 525.F, 319.5F, 239.5F};
  s.near_m = 0.001F;
  s.far_m = 65.535F;
  return s;
}

int scaled(int pixels, float scale) { return int(std::lround(float(pixels) * scale)); }

Border scaled(const Border& border, float scale) {
  return {scaled(border.left, scale), scaled(border.right, scale), scaled(border.top, scale),
          scaled(border.bottom, scale)};
}

}  // namespace

const std::vector<Sensor>& sensors() {
  static const std::vector<Sensor> all = {registered_kinect(),
                                          raw_kinect(),
                                          kinect_v2(),
                                          azure_kinect("azure-kinect"),
                                          azure_kinect("femto-bolt"),
                                          xtion(),
                                          realsense("d435", 0.05F, 0.2F),
                                          realsense("d455", 0.095F, 0.4F),
                                          perfect()};
  return all;
}

const Sensor& find_sensor(std::string_view name) {
  std::string names;
  for (const Sensor& sensor : sensors()) {
    if (sensor.name == name) return sensor;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", sensor.name);
  }
  throw UsageError(fmt::format("sensor \"{}\", expected one of {}", name, names));
}

Sensor with_camera(const Sensor& sensor, const Camera& camera) {
  check(camera);
  Sensor other = sensor;
  other.camera = camera;
  const float scale = camera.fx / sensor.camera.fx;
  for (float* pixels : {&other.lateral_px, &other.fatten_px, &other.mixed_px, &other.edge_px}) *pixels *= scale;
  other.window_px = std::max(1.F, sensor.window_px * scale);
  other.border_low = scaled(sensor.border_low, scale);
  other.border_high = scaled(sensor.border_high, scale);
  return other;
}

Sensor reframed(const Sensor& sensor, int width, int height) {
  if (width < kSmallest || width > kLargest || height < kSmallest || height > kLargest) {
    throw UsageError(fmt::format("sensor {}: picture of {}x{}, expected sides of {} to {}", sensor.name, width, height,
                                 kSmallest, kLargest));
  }
  const float scale = float(width) / float(sensor.camera.width);
  const int full = scaled(sensor.camera.height, scale);
  Camera camera = sensor.camera.resized(width, full);
  camera.fy = sensor.camera.fy * scale;  // square pixels stay square although the full height was rounded
  camera.cy -= float(full - height) * 0.5F;
  camera.height = height;
  Sensor other = with_camera(sensor, camera);
  const int cut = std::max(0, full - height) / 2;
  for (int* rows : {&other.border_low.top, &other.border_low.bottom, &other.border_high.top, &other.border_high.bottom})
    *rows = std::max(0, *rows - cut);
  return other;
}

Sensor resized(const Sensor& sensor, int width, int height) {
  const float scale = float(width) / float(sensor.camera.width);
  const int full = scaled(sensor.camera.height, scale);
  if (width < kSmallest || width > kLargest || height < kSmallest || height > full) {
    throw UsageError(fmt::format("sensor {}: picture of {}x{}, expected a width of {} to {} and a height of {} to {}",
                                 sensor.name, width, height, kSmallest, kLargest, kSmallest,
                                 std::max(kSmallest, full)));
  }
  return reframed(sensor, width, height);
}

}  // namespace vesalius::synth
