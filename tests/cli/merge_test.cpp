#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "io/files/data_file.h"
#include "io/files/extrinsics_file.h"
#include "io/files/test_files.h"
#include "run_program.h"

namespace vesalius {
namespace {

using nlohmann::json;
using test::TemporaryFolder;
using testing::HasSubstr;

/// Rendered people before two cameras that are a quarter turn apart.
class Merge : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<TemporaryFolder>();
    const Outcome run = run_program(
        "synth --clip 8 --rate 8 --cameras 2 --count 1 --seed 4 --format folder --body.kind builtin --body.count 4 "
        "--pose.captured 0 --sensor.width 320 --sensor.height 240 --people.none 0 --people.one 0 --people.two 1 "
        "--people.three 0 --people.four 0 --clip.walking-share 1 --scene.furniture-max 0 -q --out " +
        *folder / "clip");
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  static void TearDownTestSuite() { folder.reset(); }

  static std::string cameras() { return *folder / "clip/camera_0" + " " + *folder / "clip/camera_1"; }
  /// Returns the pose of a camera in the scene, by the truth of its first frame.
  static Eigen::Isometry3f truth(int camera) {
    const std::string path = *folder / "clip/camera_" + std::to_string(camera) + "/truth/0000_000000.json";
    return parse_pose(nlohmann::ordered_json::parse(read_file(path)).at("world_from_camera"), path);
  }

  static inline std::unique_ptr<TemporaryFolder> folder;
};

TEST_F(Merge, FindsWhereCamerasStandAndMakesOneList) {
  const std::string extrinsics = *folder / "cameras.json";
  const Outcome first = run_program("detect " + cameras() + " --merge --extrinsics " + extrinsics + " --json -");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err, HasSubstr("note: camera 1 ("));
  const auto found = parse_extrinsics(read_file(extrinsics), extrinsics, 2).at(1).first_from_this;
  const Eigen::Isometry3f off = (truth(0).inverse() * truth(1)).inverse() * found;
  EXPECT_LT(off.translation().norm(), 0.15F);
  EXPECT_LT(Eigen::AngleAxisf(Eigen::Matrix3f(off.linear())).angle(), 0.05F);

  std::set<int> ids;
  int by_both = 0;
  std::istringstream lines(first.out);
  for (std::string line; std::getline(lines, line);) {
    const json frame = json::parse(line);
    for (const json& person : frame.value("people", json::array())) {
      if (person["state"] == "tracked") ids.insert(person["id"].get<int>());
      by_both += person["cameras"].size() == 2 ? 1 : 0;
    }
  }
  EXPECT_EQ(ids.size(), 2U);
  EXPECT_GT(by_both, 20);
  // The file is read now, and the people are the same.
  const Outcome again =
      run_program("detect " + cameras() + " --merge --threads 1 --extrinsics " + extrinsics + " --json -");
  EXPECT_TRUE(again.out == first.out) << "not the same people";
  EXPECT_THAT(again.err, testing::Not(HasSubstr("note: camera 1")));
}

TEST_F(Merge, SaysWhatDoesNotGoTogether) {
  const auto error = [](const std::string& arguments, int code) {
    const Outcome run = run_program("detect " + arguments);
    EXPECT_EQ(run.exit_code, code) << run.err;
    return run.err;
  };
  EXPECT_THAT(error(cameras(), 2), HasSubstr("a second source; --merge makes one list"));
  EXPECT_THAT(error(*folder / "clip/camera_0" + " --merge", 2), HasSubstr("--merge expects further sources"));
  EXPECT_THAT(error(cameras() + " --merge --no-track", 2), HasSubstr("--merge follows people"));
  EXPECT_THAT(error(*folder / "clip/camera_0" + " --extrinsics x.json", 2), HasSubstr("--extrinsics expects --merge"));
  const std::string bad = test::put(*folder / "bad.json", "{}");
  EXPECT_THAT(error(cameras() + " --merge --extrinsics " + bad, 1), HasSubstr("bad.json: expected JSON"));
  const std::string out = *folder / "none.jsonl";
  EXPECT_THAT(error(*folder / "clip/camera_0" + " nowhere/ --merge --json " + out, 1), HasSubstr("nowhere/"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Merge, SaysWhereItCannotTellHowCamerasStand) {
  const std::string extrinsics = *folder / "unknown.json";
  const Outcome nobody =
      run_program("detect " + cameras() + " --merge --refine.min-score 1 --extrinsics " + extrinsics);
  EXPECT_EQ(nobody.exit_code, 1) << nobody.err;
  EXPECT_THAT(nobody.err, HasSubstr("do not see the same people for long enough"));
  EXPECT_FALSE(std::filesystem::exists(extrinsics));
}

}  // namespace
}  // namespace vesalius
