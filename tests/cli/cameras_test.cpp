#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/sensors/sensor_drivers.h"
#include "run_program.h"
#include "small_world.h"

namespace vesalius {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

bool has_openni2() { return sensor_drivers().front().built; }

/// OpenNI2 comes with a camera that is none: 320x240 at 30 frames a second.
class Cameras : public SmallWorld {
 protected:
  void SetUp() override {
    if (!has_openni2()) GTEST_SKIP() << "this build has no OpenNI2";
  }
};

TEST(CameraList, NamesEveryDriver) {
  const Outcome run = run_program("cameras");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith("openni2:"));
  if (!has_openni2()) {
    EXPECT_THAT(run.out, HasSubstr("not in this build; install libopenni2-dev and build again"));
  }
  const json facts = json::parse(run_program("info --json").out);
  EXPECT_EQ(facts.at("parts_of_this_build").at("openni2"), has_openni2() ? "present" : "absent");
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

TEST_F(Cameras, ThatAreNotThereGiveOneLine) {
  const Outcome none = run_program("detect openni2:no-such-number -m " + model());
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("openni2:no-such-number cannot be opened: "));
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
}

}  // namespace
}  // namespace vesalius
