#pragma once

#include <fmt/format.h>

#include <string>

namespace vesalius::test {

/// What calibrations of the tests differ in.
struct K4aText {
  std::string depth_lens = "0,0,0,0,0,0,0,0,0,0";  ///< k1 to k6, centre of distortion, p2 p1
  std::string colour_lens = "0,0,0,0,0,0,0,0,0,0";
  std::string colour_size = R"("SensorWidth":4096,"SensorHeight":3072)";
};

/// Returns a calibration.json. The colour camera stands 32 mm to the right of the depth camera; the accelerometer's z
/// is the camera's y, its x the camera's -z.
inline std::string k4a_json(const K4aText& of = {}) {
  const std::string camera =
      R"({{"Intrinsics":{{"ModelParameterCount":14,"ModelParameters":[{},{}],"ModelType":"CALIBRATION_LensDistortionModelBrownConrady"}},)"
      R"("Purpose":"CALIBRATION_CameraPurpose{}","Rt":{{"Rotation":[1,0,0,0,1,0,0,0,1],"Translation":[{},0,0]}},{}}})";
  const std::string depth = fmt::format(fmt::runtime(camera), "0.51,0.49,0.5,0.48", of.depth_lens, "Depth", 0,
                                        R"("SensorWidth":1024,"SensorHeight":1024)");
  const std::string colour =
      fmt::format(fmt::runtime(camera), "0.5,0.52,0.45,0.6", of.colour_lens, "PhotoVideo", -0.032, of.colour_size);
  return R"({"CalibrationInformation":{"Cameras":[)" + depth + "," + colour +
         R"(],"InertialSensors":[{"SensorType":"CALIBRATION_InertialSensorType_Gyro"},)"
         R"({"SensorType":"CALIBRATION_InertialSensorType_Accelerometer","Rt":{"Rotation":[0,0,-1,-1,0,0,0,1,0],"Translation":[0,0,0]}}]}})";
}

}  // namespace vesalius::test
