#include "synth/sensor/sensor_noise.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "synth/sensor/test_noise_scene.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using test::board;
using test::sensor_named;
using test::statistics_of;
using test::tilt;
using test::wall;
using testing::HasSubstr;

TEST(Loss, TakesHalfOfTheReadingsAtTheLargestAngle) {
  const Sensor sensor = resized(sensor_named("kinect-v1"), 80, 60);
  const auto lost_at = [&](float radians) {
    return statistics_of(sensor, 2.F, [&](Rendering& r) { tilt(r, radians); }).share_lost;
  };
  EXPECT_LT(lost_at(1.05F), 0.01);
  EXPECT_NEAR(lost_at(sensor.max_angle_rad), 0.5, 0.12);
  EXPECT_GT(lost_at(1.545F), 0.9);
}

TEST(Loss, TakesHalfOfTheReadingsAtTheDarkLimit) {
  for (const char* name : {"kinect-v1", "azure-kinect", "d435"}) {
    Sensor sensor = resized(sensor_named(name), 160, 90);
    sensor.camera.fx = sensor.camera.fy = 4000.F;  // so that all rays are near the axis
    const auto lost_at = [&](float infrared, float z_m) {
      return statistics_of(sensor, z_m, [&](Rendering& r) { r.infrared.fill(infrared); }).share_lost;
    };
    EXPECT_NEAR(lost_at(sensor.min_infrared, 2.F), 0.5, 0.15) << name;
    EXPECT_NEAR(lost_at(4.F * sensor.min_infrared, 4.F), 0.5, 0.15) << name;
    EXPECT_LT(lost_at(8.F * sensor.min_infrared, 2.F), 0.01) << name;
    EXPECT_GT(lost_at(sensor.min_infrared / 8.F, 2.F), 0.99) << name;
  }
}

TEST(Loss, MakesBlotchesRatherThanSpeckles) {
  const Sensor sensor = sensor_named("kinect-v1");
  Rendering r = wall(sensor.camera, 2.F);
  r.infrared.fill(sensor.min_infrared);
  const DepthImage depth = sense(r, sensor, Random(8));
  int alone = 0;
  int holes = 0;
  for (int v = 1; v < 479; ++v) {
    for (int u = 1; u < 639; ++u) {
      if (depth(u, v) != 0) continue;
      ++holes;
      alone += depth(u - 1, v) != 0 && depth(u + 1, v) != 0 && depth(u, v - 1) != 0 && depth(u, v + 1) != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(holes, 10000);
  EXPECT_LT(alone, holes / 100);
}

TEST(Range, EndsAtTheSensorsLimits) {
  for (const Sensor& preset : sensors()) {
    const Sensor sensor = resized(preset, 64, 32);
    const auto lost = [&](float z) { return statistics_of(sensor, z).share_lost; };
    EXPECT_EQ(lost(0.8F * sensor.near_m), 1.0) << sensor.name;
    EXPECT_EQ(lost(1.5F * sensor.far_m), 1.0) << sensor.name;
  }
}

TEST(Border, LiesBetweenItsLimitsAndVaries) {
  Sensor sensor = find_sensor("kinect-v1");
  sensor.border_low = {3, 5, 0, 2};
  sensor.border_high = {9, 5, 6, 4};
  std::vector<int> lefts;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const DepthImage depth = sense(wall(sensor.camera, 2.F), sensor, Random(9, i));
    int left = 0;
    while (depth(left, 240) == 0) ++left;
    lefts.push_back(left);
    EXPECT_NE(depth(634, 240), 0);
    for (int v = 0; v < 480; ++v) ASSERT_EQ(depth(635, v), 0);
    EXPECT_EQ(depth(320, 478), 0);
    EXPECT_NE(depth(320, 475), 0);
    EXPECT_NE(depth(320, 6), 0);
  }
  EXPECT_THAT(lefts, testing::Each(testing::AllOf(testing::Ge(3), testing::Le(9))));
  EXPECT_GT(*std::max_element(lefts.begin(), lefts.end()), *std::min_element(lefts.begin(), lefts.end()));
}

TEST(Stereo, ErrsByItsMatchingError) {
  Sensor sensor = resized(sensor_named("d435"), 212, 120);
  sensor.camera.fx = sensor.camera.fy = 1000.F;
  for (const float z : {1.F, 2.F, 3.F, 4.F}) {
    const double expected = z * z * 0.08 / (424.0 * 0.05);
    EXPECT_NEAR(statistics_of(sensor, z).sigma_m, expected, 0.1 * expected) << z;
  }
}

TEST(Stereo, HasEqualErrorsWithinItsWindow) {
  const Sensor sensor = sensor_named("d435");
  constexpr float kWall_m = 3.F;
  const auto correlation = [&](int du) {
    double product = 0.0;
    double square = 0.0;
    for (std::uint64_t i = 0; i < 4; ++i) {
      const DepthImage depth = sense(wall(sensor.camera, kWall_m), sensor, Random(10, i));
      for (int v = 0; v < 480; ++v) {
        for (int u = 200; u < 600; ++u) {
          if (depth(u, v) == 0 || depth(u + du, v) == 0) continue;
          const double error = depth(u, v) - 1000.0 * kWall_m;
          product += error * (depth(u + du, v) - 1000.0 * kWall_m);
          square += error * error;
        }
      }
    }
    return product / square;
  };
  EXPECT_GT(correlation(1), 0.85);
  EXPECT_NEAR(correlation(4), 0.4, 0.1);
  EXPECT_LT(correlation(9), 0.1);
}

TEST(Stereo, FattensSurfacesInFront) {
  Sensor sensor = sensor_named("d435");
  sensor.edge_loss = sensor.lateral_px = 0.F;
  const DepthImage depth = sense(board(sensor.camera, 1.5F, 3.F, 400, 440), sensor, Random(11));
  for (int v = 0; v < 480; ++v) {
    const auto near = std::count_if(depth.row(v), depth.row(v) + 848, [](auto mm) { return mm != 0 && mm < 2000; });
    ASSERT_EQ(near, 40 + 2 * static_cast<int>(sensor.fatten_px)) << v;
  }
}

TEST(TimeOfFlight, ErrsBySquareOfDistanceOverAmplitude) {
  for (const char* name : {"kinect-v2", "azure-kinect"}) {
    Sensor sensor = resized(sensor_named(name), 160, 120);
    sensor.camera.fx = sensor.camera.fy = 4000.F;
    for (const float z : {1.F, 2.F, 3.F, 4.F}) {
      for (const float infrared : {0.2F, 0.8F}) {
        const double rounding = 0.001 / std::sqrt(12.0);
        const double sigma = sensor.axial_base_m + sensor.amplitude_z2 * z * z / infrared;
        const double expected = std::hypot(sigma, rounding);
        const auto shade = [&](Rendering& r) { r.infrared.fill(infrared); };
        EXPECT_NEAR(statistics_of(sensor, z, shade).sigma_m, expected, 0.1 * expected) << name << z << infrared;
      }
    }
  }
}

TEST(TimeOfFlight, MixesNearAndFarOnlyAtSilhouettes) {
  const Sensor sensor = sensor_named("azure-kinect");
  const DepthImage depth = sense(board(sensor.camera, 1.5F, 3.F, 300, 340), sensor, Random(12));
  const auto between = [&](int u) {
    int count = 0;
    for (int v = 0; v < 576; ++v) count += depth(u, v) > 1600 && depth(u, v) < 2900 ? 1 : 0;
    return count / 576.0;
  };
  for (const int u : {100, 297, 298, 301, 320, 341, 500}) EXPECT_EQ(between(u), 0.0) << u;
  // The silhouette runs through half of the pixels beside it, and the driver drops half of these. The rest is weighted
  // by light.
  EXPECT_NEAR(between(299) + between(300), 0.4, 0.12);
  EXPECT_NEAR(between(339) + between(340), 0.4, 0.12);
}

TEST(Sense, RoundsThePerfectSensorToMillimetres) {
  const Sensor sensor = resized(find_sensor("perfect"), 64, 48);
  Rendering r = wall(sensor.camera, 1.2344F);
  r.lit = {};
  r.depth_m(0, 0) = 0.F;
  r.depth_m(1, 0) = 65.536F;
  r.depth_m(2, 0) = 65.5349F;
  const DepthImage depth = sense(r, sensor, Random(0));
  EXPECT_EQ(depth(0, 0), 0);
  EXPECT_EQ(depth(1, 0), 0);
  EXPECT_EQ(depth(2, 0), 65535);
  EXPECT_EQ(depth(3, 3), 1234);
}

TEST(Sense, DependsOnTheRandomStreamAlone) {
  for (const Sensor& sensor : sensors()) {
    if (sensor.kind == SensorKind::perfect) continue;
    const Rendering r = board(sensor.camera, 1.5F, 3.F, 200, 300);
    const DepthImage once = sense(r, sensor, Random(1, 2));
    EXPECT_EQ(once, sense(r, sensor, Random(1, 2))) << sensor.name;
    EXPECT_NE(once, sense(r, sensor, Random(1, 3))) << sensor.name;
  }
}

TEST(Sense, TellsTheSurfaceOfEachReading) {
  for (const char* name : {"kinect-v1", "d435", "perfect"}) {
    const Sensor sensor = sensor_named(name);
    const Rendering r = board(sensor.camera, 1.5F, 3.F, 300, 340);
    Image<std::uint32_t> source;
    const DepthImage depth = sense(r, sensor, Random(13), &source);
    EXPECT_EQ(depth, sense(r, sensor, Random(13))) << name;
    const Image<float> truth = as_read(r.depth_m, source);
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] == 0) {
        ASSERT_EQ(source[i], i);
      } else {
        ASSERT_NEAR(depth[i] * 1e-3, truth[i], 0.2) << name << ' ' << i;
      }
    }
  }
}

TEST(Sense, ReadsNothingWithoutASurface) {
  for (const Sensor& sensor : sensors()) {
    Rendering r = wall(sensor.camera, 0.F);
    r.infrared.fill(0.F);
    r.normal.fill(Eigen::Vector3f::Zero());
    EXPECT_EQ(sense(r, sensor, Random(1)), DepthImage(sensor.camera.width, sensor.camera.height, 0)) << sensor.name;
  }
}

TEST(Sense, RefusesPicturesThatDoNotFit) {
  const Sensor& sensor = find_sensor("kinect-v1");
  const auto complaint = [&](const std::function<void(Rendering&)>& change) -> std::string {
    Rendering r = wall(sensor.camera, 2.F);
    change(r);
    try {
      sense(r, sensor, Random(1));
      return "none";
    } catch (const Error& e) {
      return e.what();
    }
  };
  EXPECT_EQ(complaint([](Rendering&) {}), "none");
  EXPECT_THAT(complaint([](Rendering& r) { r.lit = {}; }), HasSubstr("what its projector lights"));
  EXPECT_THAT(complaint([](Rendering& r) { r.infrared = Image<float>(3, 3, 1.F); }), HasSubstr("one size"));
  EXPECT_THAT(complaint([](Rendering& r) { r.depth_m = {}; }), HasSubstr("one size"));
}

TEST(ProjectorOf, IsAtTheSensorsBaseline) {
  EXPECT_EQ(projector_of(find_sensor("d455")), Eigen::Vector3f(0.095F, 0.F, 0.F));
  EXPECT_FALSE(projector_of(find_sensor("azure-kinect")));
  Sensor silent = find_sensor("kinect-v1");
  silent.kind = SensorKind::perfect;
  EXPECT_FALSE(projector_of(silent));
}

}  // namespace

}  // namespace vesalius::synth
