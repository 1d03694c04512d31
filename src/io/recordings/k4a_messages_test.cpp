#include "io/recordings/k4a_messages.h"

#include <gmock/gmock.h>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "io/recordings/test_k4a.h"

namespace vesalius {
namespace {

using test::error_of;
using test::k4a_json;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(K4aCalibration, IsThatOfTheSensorPartThatAModeShows) {
  const K4aCalibration calibration = parse_k4a_calibration(k4a_json(), "k");
  const auto of = [&](int width, int height) {
    const Calibration c = k4a_depth_calibration(calibration, width, height).value();
    return std::array{c.matrix[0], c.matrix[4], c.matrix[2], c.matrix[5]};
  };
  const double fx = 0.5 * 1024, fy = 0.48 * 1024, cx = 0.51 * 1024, cy = 0.49 * 1024;
  EXPECT_EQ(of(1024, 1024), (std::array{fx, fy, cx - 0.5, cy - 0.5}));
  EXPECT_EQ(of(640, 576), (std::array{fx, fy, cx - 192 - 0.5, cy - 180 - 0.5}));
  EXPECT_EQ(of(512, 512), (std::array{fx / 2, fy / 2, cx / 2 - 0.5, cy / 2 - 0.5}));
  EXPECT_EQ(of(320, 288), (std::array{fx / 2, fy / 2, cx / 2 - 96 - 0.5, cy / 2 - 90 - 0.5}));
  EXPECT_FALSE(k4a_depth_calibration(calibration, 640, 480));
}

TEST(K4aCalibration, OfColourIsThatOfTheMiddleOfTheSensor) {
  const K4aCalibration calibration = parse_k4a_calibration(k4a_json(), "k");
  const auto of = [](const K4aCalibration& all, int width, int height) {
    const Calibration c = k4a_colour_calibration(all, width, height).value();
    return std::array{c.matrix[0], c.matrix[4], c.matrix[2], c.matrix[5]};
  };
  EXPECT_EQ(of(calibration, 2048, 1536), (std::array{0.45 * 2048, 0.6 * 1536, 0.5 * 2048 - 0.5, 0.52 * 1536 - 0.5}));
  EXPECT_EQ(of(calibration, 1920, 1080),
            (std::array{0.45 * 1920, 0.6 * 1440, 0.5 * 1920 - 0.5, 0.52 * 1440 - 180 - 0.5}));
  test::K4aText old;
  old.colour_size = R"("SensorWidth":4096,"SensorHeight":2304)";  // of a sensor's band of 16:9
  const K4aCalibration of_band = parse_k4a_calibration(k4a_json(old), "k");
  EXPECT_EQ(of(of_band, 1280, 720), (std::array{0.45 * 1280, 0.6 * 720, 0.5 * 1280 - 0.5, 0.52 * 720 - 0.5}));
  EXPECT_EQ(of(of_band, 2048, 1536), (std::array{0.45 * 2048, 0.6 * 1152, 0.5 * 2048 - 0.5, 0.52 * 1152 + 192 - 0.5}));
}

TEST(K4aCalibration, OrdersCoefficientsAsOpenCvDoes) {
  test::K4aText text;
  text.depth_lens = "1,2,3,4,5,6,0,0,7,8";
  const Calibration c = k4a_depth_calibration(parse_k4a_calibration(k4a_json(text), "k"), 640, 576).value();
  EXPECT_EQ(c.model, "rational_polynomial");
  EXPECT_THAT(c.distortion, ElementsAre(1, 2, 8, 7, 3, 4, 5, 6));
}

TEST(K4aCalibration, TransformsLeadFromTheDepthCamera) {
  const K4aCalibration calibration = parse_k4a_calibration(k4a_json() + std::string(3, '\0'), "k");
  EXPECT_TRUE(
      (calibration.colour->sensor_from_depth * Eigen::Vector3d(0.032, 0, 1)).isApprox(Eigen::Vector3d(0, 0, 1)));
  // Up is -y of the camera: the accelerometer at rest measures it along -z.
  EXPECT_TRUE((*calibration.accelerometer_from_depth * Eigen::Vector3d(0, -1, 0)).isApprox(Eigen::Vector3d(0, 0, -1)));
}

TEST(K4aCalibration, NamesTheKeyOfErrors) {
  const auto message = [](std::string text, const std::string& what, const std::string& with) {
    if (const std::size_t at = text.find(what); at != text.npos) text.replace(at, what.size(), with);
    return error_of([&] { parse_k4a_calibration(text, "a.mkv: calibration.json"); });
  };
  EXPECT_THAT(message("{", "", ""), HasSubstr("a.mkv: calibration.json: not JSON"));
  EXPECT_THAT(message("[]", "", ""), HasSubstr("no \"CalibrationInformation\""));
  EXPECT_THAT(message(k4a_json(), "PurposeDepth", "Purpose"),
              HasSubstr("expected one of CALIBRATION_CameraPurposeDepth"));
  EXPECT_THAT(message(k4a_json(), "[0.51,", "["), HasSubstr("\"ModelParameters\": expected a list of 14 numbers"));
  EXPECT_THAT(message(k4a_json(), "[0.51,0.49,0.5", "[0.51,0.49,0"), HasSubstr("positive focal lengths"));
  EXPECT_THAT(message(k4a_json(), "BrownConrady", "Other"), HasSubstr("\"ModelType\""));
  EXPECT_THAT(message(k4a_json(), "[1,0,0,0,1,0,0,0,1]", "[1,0,0,0,1,0,0,0,2]"), HasSubstr("expected a rotation"));
  EXPECT_THAT(message(k4a_json(), "1024", "640"), HasSubstr("depth sensor of 640x1024 pixels, expected 1024x1024"));
}

TEST(K4aAcceleration, IsThePartOfAMeasurement) {
  ByteWriter out;
  out.number(std::uint64_t{12'345'678'901});
  for (const float axis : {1.F, -2.F, 9.5F}) out.real(axis);
  out.number(std::uint64_t{1});
  for (int i = 0; i < 3; ++i) out.real(0.F);
  const K4aAcceleration sample = parse_k4a_acceleration(out.bytes(), "k");
  EXPECT_EQ(sample.time_ns, 12'345'678'901);
  EXPECT_EQ(sample.m_s2, Eigen::Vector3d(1, -2, 9.5));
  EXPECT_THAT(error_of([&] { parse_k4a_acceleration("short", "k"); }),
              HasSubstr("k: a measurement of 5 bytes, expected 40"));
}

}  // namespace
}  // namespace vesalius
