#include "dataset/truth_folder.h"

#include <numbers>

#include "io/files/test_files.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Frame frame(const std::string& name, int width = 4, int height = 3) {
  return test::random_frame(name, 1, width, height);
}

void put_mask(const std::string& path, int width, int height, std::uint8_t fill) {
  test::put(path, encode_png(Image<std::uint8_t>(width, height, fill)));
}

TEST(TruthFolder, ReadsPeopleFromATableOfSeveralSets) {
  const test::TemporaryFolder folder;
  test::put(folder / "frames.csv", "set,frame,people,posture,has_rgb\nroom,a,2,sitting,1\nroom,b,0,,1\nhall,a,-1,,1\n");
  test::put(folder / "room/depth/a.png", "");
  const TruthFolder room(folder / "room/");
  EXPECT_EQ(room.truth_of(frame("a")).people, 2);
  EXPECT_EQ(room.truth_of(frame("a")).posture, "sitting");
  EXPECT_EQ(room.truth_of(frame("b")).people, 0);
  EXPECT_TRUE(room.truth_of(frame("a")).mask.empty());
  EXPECT_THAT(test::error_of([&] { room.truth_of(frame("c")); }), HasSubstr("nothing is known of frame c"));
}

TEST(TruthFolder, ReadsPeopleFromATableInTheFolder) {
  const test::TemporaryFolder folder;
  test::put(folder / "set/frames.csv", "frame,people\na.png,3\n");
  test::put(folder / "frames.csv", "set,frame,people\nset,a,1\n");
  EXPECT_EQ(TruthFolder(folder / "set").truth_of(frame("a")).people, 3);
}

TEST(TruthFolder, ReadsMasks) {
  const test::TemporaryFolder folder;
  test::put(folder / "frames.csv", "frame,people\na,1\nblank,1\nempty,0\n");
  put_mask(folder / "mask/a.png", 4, 3, 4);
  put_mask(folder / "mask/blank.png", 4, 3, 0);
  put_mask(folder / "mask/empty.png", 4, 3, 0);
  put_mask(folder / "mask/only.png", 4, 3, 255);
  const TruthFolder truth(folder.path());
  EXPECT_EQ(truth.truth_of(frame("a")).mask, Mask(4, 3, 1));
  EXPECT_TRUE(truth.truth_of(frame("blank")).mask.empty());  // a person without pixels: the mask was not made
  EXPECT_EQ(truth.truth_of(frame("empty")).mask, Mask(4, 3, 0));
  EXPECT_EQ(truth.truth_of(frame("only")).people, -1);
  EXPECT_THAT(test::error_of([&] { truth.truth_of(frame("a", 8, 6)); }),
              HasSubstr("mask/a.png: 4x3 pixels, expected those of the frame, 8x6"));
}

TEST(TruthFolder, ReadsJoints) {
  const test::TemporaryFolder folder;
  test::put(folder / "joints.csv",
            "frame,joint,x_m,y_m,z_m,u_px\na.png,head,0.1,-0.5,2.5,3\na.png,hand,0.2,0,2,4\nb.png,hand,1,2,3,5\n");
  const TruthFolder truth(folder.path());
  const FrameTruth a = truth.truth_of(frame("a"));
  EXPECT_EQ(a.people, 1);
  EXPECT_THAT(a.joint_names, ElementsAre("head", "hand"));
  EXPECT_EQ(a.joints[0][0], Eigen::Vector3f(0.1F, -0.5F, 2.5F));
  const FrameTruth b = truth.truth_of(frame("b"));
  EXPECT_TRUE(b.joints[0][0].hasNaN());
  EXPECT_EQ(b.joints[0][1], Eigen::Vector3f(1, 2, 3));
}

TEST(TruthFolder, KnowsTheUpwardDirectionOfATrackedCamera) {
  const test::TemporaryFolder folder;
  test::put(folder / "frames.csv", "frame,people\na,1\n");
  // The camera looks along the world's x axis, and its own x axis points down: it is rolled by 90 degrees.
  test::put(folder / "groundtruth.txt", "7.0 0 0 0 0 0.70710678 0 0.70710678\n");
  Frame at = frame("a");
  at.time_s = 7.0;
  const FrameTruth truth = TruthFolder(folder.path()).truth_of(at);
  ASSERT_TRUE(truth.up);
  EXPECT_LT((*truth.up - Eigen::Vector3f(-1, 0, 0)).norm(), 1e-5F);
  at.time_s = 9.0;
  EXPECT_FALSE(TruthFolder(folder.path()).truth_of(at).up);
  test::put(folder / "frames.csv", "frame,people\n7.000,1\n7.0x,1\n");  // without times, names may be times
  EXPECT_TRUE(TruthFolder(folder.path()).truth_of(frame("7.000")).up);
  EXPECT_FALSE(TruthFolder(folder.path()).truth_of(frame("7.0x")).up);
}

TEST(TruthFolder, IsOneRecordingInWhichTheOnlyPersonHasAnId) {
  const test::TemporaryFolder folder;
  test::put(folder / "frames.csv", "frame,people\na,1\nb,0\nc,-1\n");
  const auto ids = [&](const char* name) {
    const FrameTruth truth = TruthFolder(folder.path()).truth_of(frame(name));
    EXPECT_EQ(truth.sequence, 0);
    return truth.ids;
  };
  EXPECT_THAT(ids("a"), ElementsAre(0));
  EXPECT_THAT(ids("b"), IsEmpty());
  EXPECT_THAT(ids("c"), ElementsAre(0));
  test::put(folder / "frames.csv", "frame,people\na,1\nb,2\n");  // who of the two is the one?
  EXPECT_THAT(ids("a"), IsEmpty());
  test::put(folder / "frames.csv", "frame,people\na,-1\nb,-1\n");  // there may always be more
  EXPECT_THAT(ids("a"), IsEmpty());
  std::filesystem::remove(folder / "frames.csv");
  test::put(folder / "joints.csv", "frame,joint,x_m,y_m,z_m\na,head,0,0,2\n");
  EXPECT_THAT(ids("a"), ElementsAre(0));
}

TEST(TruthFolder, NamesMissingAndWrongFiles) {
  const test::TemporaryFolder folder;
  const auto error = [&](const std::string& file, const std::string& text) {
    test::put(folder / file, text);
    const std::string message = test::error_of([&] { TruthFolder(folder.path()); });
    std::filesystem::remove(folder / file);
    return message;
  };
  EXPECT_THAT(test::error_of([&] { TruthFolder(folder.path()); }), HasSubstr("no truth, expected frames.csv"));
  EXPECT_THAT(error("frames.csv", "frame,posture\na,sitting\n"), HasSubstr("no column \"people\""));
  EXPECT_THAT(error("frames.csv", "people\n1\n"), HasSubstr("no column \"frame\""));
  EXPECT_THAT(error("frames.csv", "frame,people\na,many\n"), HasSubstr("frames.csv:2: column people: \"many\""));
  EXPECT_THAT(error("frames.csv", "frame,people\na,-2\n"), HasSubstr("expected a whole number from -1 to 1000"));
  EXPECT_THAT(error("frames.csv", "frame,people\na,1\na.png,1\n"), HasSubstr("frames.csv:3: frame a comes twice"));
  test::put(folder / "mask/a.png", "");
  EXPECT_THAT(error("groundtruth.txt", "1 2 3\n"), HasSubstr("groundtruth.txt:1: expected \"timestamp tx"));
  std::filesystem::remove_all(folder / "mask");
  EXPECT_THAT(error("joints.csv", "frame,joint,x_m,y_m\na,head,0,0\n"), HasSubstr("no column \"z_m\""));
  EXPECT_THAT(error("joints.csv", "frame,joint,x_m,y_m,z_m\na,head,0,0,nan\n"),
              HasSubstr("\"nan\", expected a finite"));
  EXPECT_THAT(error("joints.csv", "frame,joint,x_m,y_m,z_m\na,head,0,0,2500\n"), HasSubstr("expected metres"));
  EXPECT_THAT(error("joints.csv", "frame,joint,x_m,y_m,z_m\na,head,0,0,2\na,head,0,0,2\n"),
              HasSubstr("joints.csv:3: joint head of frame a comes twice"));
}

TEST(SetsIn, FindsFoldersOfTheTableAndThoseWithJoints) {
  const test::TemporaryFolder folder;
  test::put(folder / "frames.csv", "set,frame,people\nroom_10,a,1\nroom_9,a,1\ngone,a,1\n");
  test::put(folder / "room_10/depth/a.png", "");
  test::put(folder / "room_9/depth/a.png", "");
  test::put(folder / "dancer/joints.csv", "");
  test::put(folder / "other/depth/a.png", "");
  EXPECT_THAT(sets_in(folder.path()), ElementsAre(folder / "dancer", folder / "room_9", folder / "room_10"));
  EXPECT_THAT(sets_in(folder / "room_9"), ElementsAre(folder / "room_9"));
  EXPECT_THAT(sets_in("/nowhere"), ElementsAre("/nowhere"));
}

TEST(SetsIn, FindsNoneOfTheTablesFolders) {
  const test::TemporaryFolder folder;
  test::put(folder / "frames.csv", "set,frame,people\ngone,a,1\n");
  EXPECT_THAT(test::error_of([&] { sets_in(folder.path()); }), HasSubstr("none of the sets"));
}

TEST(Trajectory, InterpolatesBetweenPoses) {
  // The camera turns a quarter about its y axis.
  const Trajectory trajectory = Trajectory::parse(
      "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n\n"
      "10.00 0 0 0 0 0 0 1\r\n10.10 1 0 2 0 0.70710678 0 0.70710678\n",
      "t");
  const auto middle = trajectory.world_from_camera(10.05);
  ASSERT_TRUE(middle);
  const Eigen::AngleAxisd turn(*middle);
  EXPECT_NEAR(turn.angle(), std::numbers::pi / 4, 1e-6);
  // After an eighth of a turn about y the camera looks between the world's z and x.
  EXPECT_TRUE((*middle * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(1, 0, 1).normalized(), 1e-6));
  EXPECT_TRUE(trajectory.world_from_camera(10.0)->isApprox(Eigen::Quaterniond::Identity()));
  EXPECT_NEAR(Eigen::AngleAxisd(*trajectory.world_from_camera(10.1)).angle(), std::numbers::pi / 2, 1e-6);
}

TEST(Trajectory, HasNoPoseOutsideTheRecordingAndInGaps) {
  const Trajectory trajectory = Trajectory::parse("1 0 0 0 0 0 0 1\n1.2 0 0 0 0 0 0 1\n", "t");
  for (const double time_s : {0.99, 1.1, 1.21}) EXPECT_FALSE(trajectory.world_from_camera(time_s)) << time_s;
  EXPECT_TRUE(trajectory.world_from_camera(1.2));
}

TEST(Trajectory, NamesTheLineOfErrors) {
  const auto error = [](const std::string& text) { return test::error_of([&] { Trajectory::parse(text, "g.txt"); }); };
  EXPECT_THAT(error("# nothing\n"), HasSubstr("g.txt: no pose"));
  for (const char* line : {"1 2 3", "1 0 0 0 0 0 0 1 9", "1 0 0 0 0 0 0 x", "1 0 0 0 0 0 0 1x", "nan 0 0 0 0 0 0 1"}) {
    EXPECT_EQ(error("# c\n" + std::string(line)), "g.txt:2: expected \"timestamp tx ty tz qx qy qz qw\"");
  }
  EXPECT_THAT(error("1 0 0 0 0 0 0 0\n"), HasSubstr("g.txt:1: a quaternion of length 0, expected 1"));
  EXPECT_THAT(error("2 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"), HasSubstr("g.txt:2: a time that does not come after"));
}

}  // namespace

}  // namespace vesalius
