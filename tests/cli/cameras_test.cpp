#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "io/sensors/sensor_drivers.h"
#include "run_program.h"
#include "small_world.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

bool has(std::string_view scheme) { return std::ranges::find(sensor_drivers(), scheme, &SensorDriver::scheme)->built; }

/// OpenNI2 comes with a camera that is none: 320x240 at 30 frames a second.
class Cameras : public SmallWorld {
 protected:
  void SetUp() override {
    if (!has("openni2")) GTEST_SKIP() << "this build has no OpenNI2";
  }
};

TEST(CameraList, NamesEveryDriver) {
  const Outcome run = run_program("cameras");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith("openni2:"));
  if (!has("openni2")) {
    EXPECT_THAT(run.out, HasSubstr("not in this build; install libopenni2-dev and build again"));
  }
  const json facts = json::parse(run_program("info --json").out);
  EXPECT_EQ(facts.at("parts_of_this_build").at("openni2"), has("openni2") ? "present" : "absent");
}

TEST_F(Cameras, GiveFramesUntilThereAreEnough) {
  const Outcome run = run_program("detect openni2:Dummy -q --frames 3 --json - -m " + model());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::vector<json> lines;
  std::istringstream in(run.out);
  for (std::string line; std::getline(in, line);) lines.push_back(json::parse(line));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0].at("camera").at("width"), 320);
  EXPECT_LT(lines[0].at("time_s"), lines[1].at("time_s"));
  EXPECT_LT(lines[0].at("arrived_s"), lines[1].at("arrived_s"));
  EXPECT_GT(lines[0].at("latency_ms"), 0.0);
}

TEST_F(Cameras, AreRecordedAndReadBack) {
  const Outcome run = run_program("record openni2:Dummy --frames 5 --out " + path("camera.mcap"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("camera.mcap: 5 frames"));
  const Outcome back = run_program("detect " + path("camera.mcap") + " -m " + model());
  EXPECT_EQ(back.exit_code, 0) << back.err;
  EXPECT_THAT(back.err, HasSubstr("5 frames"));
}

TEST_F(Cameras, AreEndedBySignalsWithoutAnError) {
  // The first picture is there when the signal is sent, however slow the machine is.
  const std::string pictures = path("live/overlay");
  const Outcome run = run_program("detect openni2:Dummy -m " + model() + " --out " + path("live") +
                                  " & p=$!; i=0; while [ $i -lt 500 ] && ! ls -A " + pictures +
                                  " 2>/dev/null | grep -q .; do sleep 0.1; i=$((i + 1)); done; kill -TERM $p; wait $p");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("frames/s"));
}

TEST_F(Cameras, LeaveNoThreadBehind) {
  const auto threads = [] {
    const std::filesystem::directory_iterator all("/proc/self/task");
    return std::distance(begin(all), end(all));
  };
  const auto use_camera = [] { ASSERT_TRUE(open_source("openni2:Dummy")->next()); };
  use_camera();  // starts the library
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto before = threads();
  for (int i = 0; i < 3; ++i) {
    use_camera();
    EXPECT_EQ(threads(), before) << "one goes on with a camera that is closed";
  }
}

TEST_F(Cameras, AreMeasuredForSoManyFrames) {
  const Outcome all = run_program("bench openni2:Dummy -m " + model());
  EXPECT_EQ(all.exit_code, 2);
  EXPECT_THAT(all.err, HasSubstr("openni2:Dummy: expected --frames N"));
  const Outcome run = run_program("bench openni2:Dummy --frames 3 --threads 1 -q --json - -m " + model());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json::parse(run.out);
  EXPECT_EQ(figures.at("frames"), 3);
  EXPECT_FALSE(figures.at("runs").at(0).at("stages").contains("read"));
}

TEST_F(Cameras, ThatAreNotThereGiveOneLine) {
  const Outcome none = run_program("detect openni2:no-such-number -m " + model());
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("openni2:no-such-number: no camera is plugged in, expected one that"));
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
}

class OrbbecCameras : public SmallWorld {
 protected:
  /// Returns where the lens of the library's cameras puts what a pinhole camera of these intrinsics sees at a pixel.
  static Eigen::Vector2d bent(const Camera& camera, int u, int v) {
    const Eigen::Vector3d ray = camera.point(static_cast<float>(u), static_cast<float>(v), 1.F).cast<double>();
    const double x = ray.x(), y = ray.y(), r2 = x * x + y * y;
    const double radial = (1 - 0.1 * r2 + 0.02 * r2 * r2) / (1 + 0.05 * r2), p1 = 0.002, p2 = 0.004;
    return {camera.cx + camera.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)),
            camera.cy + camera.fy * (y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y))};
  }

  /// Runs the program with a library and a camera that are none (fake_orbbec.cpp).
  static Outcome run(const std::string& arguments, const std::string& words = "-") {
    return run_program(arguments, "VESALIUS_ORBBEC='" VESALIUS_FAKE_ORBBEC "' FAKE_ORBBEC=" + words);
  }
};

TEST_F(OrbbecCameras, AreListedAndGiveRegisteredMillimetres) {
  EXPECT_THAT(run("cameras").out, HasSubstr("orbbec:F1  Fake Femto"));
  ASSERT_EQ(run("record orbbec:F1 --frames 4 --out " + path("orbbec.mcap")).exit_code, 0);
  const auto source = open_source(path("orbbec.mcap"));
  for (int i = 0; i < 4; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->camera, (Camera{640, 480, 600.F, 601.F, 321.F, 242.F})) << "not the colour camera's";
    EXPECT_EQ(frame->depth(5, 5), 1001 + i + 5) << "registered depth has no lens";
    EXPECT_EQ(frame->colour(321, 242), (Rgb{static_cast<std::uint8_t>(i), 80, 60}));
    EXPECT_NEAR(*frame->time_s, 1.0 + 0.033333 * i, 1e-6);
    for (const auto& [u, v] : {std::pair(5, 5), {600, 30}, {40, 470}, {630, 470}}) {
      const Eigen::Vector2d from = bent(frame->camera, u, v);
      EXPECT_NEAR(frame->colour(u, v).g, from.x() / 4, 1.5) << "its lens stays";
      EXPECT_NEAR(frame->colour(u, v).b, from.y() / 4, 1.5);
    }
  }
}

TEST_F(OrbbecCameras, OfAnSdkThatRegistersWithTheLensGiveBothWithout) {
  const Outcome recorded = run("record orbbec: --frames 1 --out " + path("old.mcap"), "old");
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  const auto frame = open_source(path("old.mcap"))->next();
  ASSERT_TRUE(frame);
  const Eigen::Vector2d from = bent(frame->camera, 5, 5);
  ASSERT_GT(from.x(), 10.0);
  EXPECT_NEAR(frame->depth(5, 5), 1001 + from.x(), 1.0);
  EXPECT_NEAR(frame->colour(5, 5).g, from.x() / 4, 1.5);
}

TEST_F(OrbbecCameras, WithoutColourGiveDepthOnItsOwnGrid) {
  const Outcome recorded = run("record orbbec: --frames 1 --out " + path("grey.mcap"), "grey");
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_THAT(recorded.err, HasSubstr("orbbec: depth alone, since it gives no RGB"));
  const auto frame = open_source(path("grey.mcap"))->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->camera.fx, 500.F);
  EXPECT_NEAR(frame->depth(5, 5), 1000 + bent(frame->camera, 5, 5).x(), 1.0) << "its lens stays";
  EXPECT_TRUE(frame->colour.empty());
}

TEST_F(OrbbecCameras, KnowWhichWayIsUp) {
  ::setenv("VESALIUS_ORBBEC", VESALIUS_FAKE_ORBBEC, 1);
  const auto frame = open_source("orbbec:F1")->next();
  ASSERT_TRUE(frame && frame->up);
  EXPECT_EQ(*frame->up, Eigen::Vector3f(0.F, -1.F, 0.F)) << "its sensor's x axis points up";
}

TEST_F(OrbbecCameras, AreWaitedForWhenTheyAreLost) {
  const std::string file = path("waited.mcap");
  const Outcome gone = run("record orbbec: --frames 9 --out " + path("gone.mcap"), "lost");
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_THAT(gone.err, testing::StartsWith("vesalius: orbbec: the device was disconnected; "));
  EXPECT_THAT(gone.err, testing::MatchesRegex(".*gone.mcap has the [0-9]+ frames before\n"));
  const Outcome waited = run("record orbbec: --frames 9 --reconnect --out " + file, "lost");
  ASSERT_EQ(waited.exit_code, 0) << waited.err;
  EXPECT_THAT(waited.err, HasSubstr("orbbec: the device was disconnected; waiting until it is back\n"));
  EXPECT_THAT(waited.err, HasSubstr("vesalius: orbbec: back after "));
  EXPECT_THAT(waited.err, HasSubstr("waited.mcap: 9 frames\n"));
  EXPECT_EQ(std::count(waited.err.begin(), waited.err.end(), '\n'), 3) << waited.err;
  const auto source = open_source(file);
  double before_s = 0.0, longest_s = 0.0;
  while (const auto frame = source->next()) {
    if (before_s > 0.0) longest_s = std::max(longest_s, *frame->time_s - before_s);
    EXPECT_GT(*frame->time_s, before_s);
    before_s = *frame->time_s;
  }
  EXPECT_GT(longest_s, 1.0) << "the time in which the camera was away is missing";
}

TEST_F(OrbbecCameras, ThatAreLostEndEvenWhatKeepsGoing) {
  const Outcome gone =
      run("detect orbbec: -q --keep-going --frames 9 --json " + path("gone.json") + " -m " + model(), "lost");
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_EQ(gone.err, "vesalius: orbbec: the device was disconnected\n");
}

TEST_F(OrbbecCameras, ThatAreNotThereOrInUseGiveOneLine) {
  EXPECT_EQ(run("detect orbbec: -m " + model(), "none").err,
            "vesalius: orbbec: no camera is plugged in, expected one that `vesalius cameras` lists\n");
  EXPECT_EQ(run("detect orbbec:F2 -m " + model()).err,
            "vesalius: orbbec:F2: no such camera, expected one of orbbec:F1\n");
  const Outcome busy = run("detect orbbec:F1 -m " + model(), "busy");
  EXPECT_EQ(busy.exit_code, 1);
  EXPECT_THAT(busy.err, HasSubstr("orbbec:F1 cannot be opened: uvc device: resource busy; end any other program"));
  const Outcome other = run_program("detect orbbec: -m " + model(), "VESALIUS_ORBBEC=/dev/null");
  EXPECT_THAT(other.err, HasSubstr("libOrbbecSDK is not installed, expected version 2"));
  EXPECT_EQ(std::count(other.err.begin(), other.err.end(), '\n'), 1) << other.err;
}

#ifdef VESALIUS_FAKENECT
/// fakenect plays frames from files in the place of a Kinect.
TEST_F(Cameras, OfKinectGiveDepthAndColourOfOneMomentAndUp) {
  if (!has("freenect")) GTEST_SKIP() << "this build has no libfreenect";
  constexpr int kWidth = 640, kHeight = 480, kFrames = 12;
  std::filesystem::create_directories(path("kinect"));
  // What the base of a level Kinect measures, as a freenect_raw_tilt_state: x, y, z, of which 819 are gravity, the
  // tilt's angle and status. Pictures begin after it has been asked for that, which it is five times a second.
  constexpr std::array<std::int16_t, 6> kLevel{0, 819, 0, 0, 0, 0};
  write("kinect/a-1000.000000-0.dump", std::string(reinterpret_cast<const char*>(kLevel.data()), sizeof kLevel));
  std::string index = "a-1000.000000-0.dump\n";
  for (int i = 0; i < kFrames; ++i) {
    const std::string time = fmt::format("{:.6f}-{}", 1000.3 + i / 30.0, 1000000 + i * 2000000);
    std::string depth = "P5 640 480 65535\n", colour = "P6 640 480 255\n";
    for (int p = 0; p < kWidth * kHeight; ++p) {
      const int z = 1000 + 10 * i + p % kWidth;
      depth += static_cast<char>(z & 0xFF);  // as the camera's memory, not as PGM would have it
      depth += static_cast<char>(z >> 8);
      colour += {static_cast<char>(i), 2, 3};
    }
    write("kinect/d-" + time + ".pgm", depth);
    write("kinect/r-" + time + ".ppm", colour);
    index += "d-" + time + ".pgm\nr-" + time + ".ppm\n";
  }
  write("kinect/INDEX.txt", index);
  const Outcome run = run_program("record freenect: --frames 6 --out " + path("kinect.mcap"),
                                  "FAKENECT_PATH=" + path("kinect") + " LD_PRELOAD='" VESALIUS_FAKENECT "'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto source = open_source(path("kinect.mcap"));
  ASSERT_EQ(source->size(), 6);
  double before_s = -1.0;
  std::optional<Eigen::Vector3f> up;
  while (const auto frame = source->next()) {
    const int i = (frame->depth(0, 0) - 1000) / 10;
    ASSERT_EQ(frame->depth.width(), kWidth);
    EXPECT_EQ(frame->depth(600, 470), 1000 + 10 * i + 600);
    ASSERT_FALSE(frame->colour.empty());
    EXPECT_EQ(frame->colour(5, 5), (Rgb{static_cast<std::uint8_t>(i), 2, 3}));
    EXPECT_GT(*frame->time_s, before_s);
    before_s = *frame->time_s;
    up = frame->up;
  }
  ASSERT_TRUE(up);
  EXPECT_LT((*up - Eigen::Vector3f(0.F, -1.F, 0.F)).norm(), 1e-5F) << up->transpose();
}
#endif

}  // namespace
}  // namespace vesalius
