#include "commands/evaluate/truth_bvh.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// A chain of hips, knee and foot in centimetres that hangs down at rest. In frame 1 the thigh points along +x.
constexpr const char* kBvh = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Knee
  {
    OFFSET 0 -40 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT Foot
    {
      OFFSET 0 -30 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      End Site
      {
        OFFSET 0 0 10
      }
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.1
0 100 0 0 0 0 0 0 0 0 0 0
0 100 0 90 0 0 0 0 0 0 0 0
)";

/// Three pictures of a camera 3 m in front of the world's origin and 1 m up. It looks at the origin, and its own y axis
/// points down.
class TruthBvh : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "depth");
    for (const char* name : {"a", "b", "c"}) {
      write_png(DepthImage(6, 4, 1000), (folder_ / "depth" / (std::string(name) + ".png")).string());
    }
    put("meta.json", R"({"fx": 5, "fy": 5, "cx": 2.5, "cy": 1.5, "width": 6, "height": 4})");
    put("walk.bvh", kBvh);
    put("table.txt", "0 1311867170.1 1\n1 1311867170.2 0\n");
    put("truth_bvh.toml", kToml);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void put(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  std::unique_ptr<TruthSource> open(int step = 1) const { return open_evaluation_truth(folder_.string(), step); }
  std::string refusal(const std::string& toml) const {
    put("truth_bvh.toml", toml);
    try {
      const auto source = open();
      while (source->next()) {
      }
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      return e.what();
    }
    return "nothing";
  }

  const std::string kToml =
      "motion = \"walk.bvh\"\ncamera-from-world = \"1 0 0 0  0 -1 0 1  0 0 -1 3\"\n"
      "joints = \"l_hip=Hips l_knee=Knee l_foot=Foot\"\nframes = \"table.txt\"\njoint-set = \"nite15\"\n";
  const fs::path folder_ = fs::temp_directory_path() / ("vesalius_truth_bvh_" + std::to_string(::getpid()));
};

void expect_near(const Eigen::Vector3f& found, const Eigen::Vector3f& expected) {
  EXPECT_LT((found - expected).norm(), 1e-5F) << found.transpose() << ", expected " << expected.transpose();
}

TEST_F(TruthBvh, PutsJointsInTheCamerasFrame) {
  const auto source = open();
  EXPECT_EQ(source->size(), 3);
  const auto a = source->next();  // frame 1 of the motion, with the thigh turned by 90 degrees about z
  EXPECT_EQ(a->truth.people, 1);
  EXPECT_EQ(a->truth.joint_set, "nite15");
  EXPECT_THAT(a->truth.joint_names, ElementsAre("l_hip", "l_knee", "l_foot"));
  ASSERT_EQ(a->truth.joints.size(), 1U);
  expect_near(a->truth.joints[0][0], {0, 0, 3});
  expect_near(a->truth.joints[0][1], {0.4F, 0, 3});
  expect_near(a->truth.joints[0][2], {0.7F, 0, 3});
  const auto b = source->next();
  expect_near(b->truth.joints[0][2], {0, 0.7F, 3});
  const auto c = source->next();  // the table has no third line
  EXPECT_EQ(c->truth.people, 1);
  EXPECT_TRUE(c->truth.joints.empty());
  EXPECT_FALSE(source->next());
  EXPECT_EQ(open(2)->size(), 2);
}

TEST_F(TruthBvh, FollowsAMovingCamera) {
  // In TUM's layout names are times. The camera looks along the world's -z and moves back by 1 m.
  fs::remove_all(folder_ / "depth");
  fs::remove(folder_ / "meta.json");
  write_png(DepthImage(640, 480, 5000), (folder_ / "d.png").string());
  put("depth.txt", "1311867170.00 d.png\n1311867170.10 d.png\n1311867190 d.png\n");
  put("groundtruth.txt", "1311867170.00 0 1 3 1 0 0 0\n1311867170.05 0 1 3.5 1 0 0 0\n1311867170.10 0 1 4 1 0 0 0\n");
  put("truth_bvh.toml",
      "motion = \"walk.bvh\"\ncamera-trajectory = \"groundtruth.txt\"\njoints = \"l_foot=Foot\"\n"
      "start = \"1311867170\"\n");
  const auto source = open();
  expect_near(source->next()->truth.joints[0][0], {0, 0.7F, 3});
  expect_near(source->next()->truth.joints[0][0], {0.7F, 0, 4});
  EXPECT_TRUE(source->next()->truth.joints.empty());  // long after the motion and the trajectory have ended
}

TEST_F(TruthBvh, OpensOtherFoldersAsBefore) {
  fs::remove(folder_ / "truth_bvh.toml");
  put("frames.csv", "frame,people\na,2\nb,1\nc,0\n");
  EXPECT_EQ(open()->next()->truth.people, 2);
}

TEST_F(TruthBvh, NamesMissingAndWrongOptions) {
  const auto without = [&](const std::string& key) {
    std::string toml = kToml;
    const std::size_t at = toml.find(key + " =");
    return toml.erase(at, toml.find('\n', at) + 1 - at);
  };
  EXPECT_EQ(refusal(kToml), "nothing");
  EXPECT_THAT(refusal(without("motion")), HasSubstr("truth_bvh.toml: expected motion = "));
  EXPECT_THAT(refusal(without("joints")), HasSubstr("expected joints = "));
  EXPECT_THAT(refusal(without("camera-from-world")), HasSubstr("either camera-from-world or camera-trajectory"));
  EXPECT_THAT(refusal(without("frames")), HasSubstr("frame a has no time, expected a table as frames"));
  EXPECT_THAT(refusal(kToml + "frames-column = 2\n"), HasSubstr("table.txt:1: "));
  EXPECT_THAT(refusal(kToml + "frames-column = 4\n"), HasSubstr("table.txt:1: expected 4 columns, found 3"));
  EXPECT_THAT(refusal(kToml + "start = \"noon\"\n"), HasSubstr("start: expected seconds"));
  EXPECT_THAT(refusal(without("joints") + "joints = \"l_hip=Hip\"\n"), HasSubstr("no joint \"Hip\""));
  EXPECT_THAT(refusal(without("joints") + "joints = \"l_hip\"\n"), HasSubstr("expected OURS=THEIRS, found \"l_hip\""));
  const std::string no_camera = without("camera-from-world");
  EXPECT_THAT(refusal(no_camera + "camera-from-world = \"1 0 0\"\n"), HasSubstr("expected twelve numbers"));
  EXPECT_THAT(refusal(no_camera + "camera-from-world = \"2 0 0 0 0 2 0 0 0 0 2 0\"\n"), HasSubstr("a rotation"));
  put("table.txt", "0 0 2\n");
  EXPECT_THAT(refusal(kToml), HasSubstr("table.txt:1: "));
}

}  // namespace
}  // namespace vesalius::cli
