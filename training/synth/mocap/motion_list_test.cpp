#include "synth/mocap/motion_list.h"

#include <gmock/gmock.h>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::vector<std::string> kPaths = {"m/b/02_01.amc", "m/b/02.asf",  "m/a/x.bvh", "m/readme.txt", "m/c/02_07.amc",
                                         "m/d/K_y_1.amc", "m/d/K_y.asf", "m/d/K.asf", "m/a.b/noext",  "m/d/K.amc"};

std::vector<std::string> paths_of(const std::vector<MotionFile>& motions) {
  std::vector<std::string> out;
  for (const MotionFile& motion : motions) out.push_back(motion.path);
  return out;
}

TEST(ListMotions, FindsMotionsAndTheirSkeletons) {
  const std::vector<MotionFile> motions = list_motions(kPaths);
  EXPECT_THAT(paths_of(motions),
              ElementsAre("m/a/x.bvh", "m/b/02_01.amc", "m/c/02_07.amc", "m/d/K.amc", "m/d/K_y_1.amc"));
  EXPECT_EQ(motions[0].skeleton, "");
  EXPECT_EQ(motions[0].description, "x");
  EXPECT_EQ(motions[1].skeleton, "m/b/02.asf");
  EXPECT_EQ(motions[2].skeleton, "") << "none in its folder";
  EXPECT_EQ(motions[3].skeleton, "m/d/K.asf");
  EXPECT_EQ(motions[4].skeleton, "m/d/K_y.asf") << "the longest beginning";
}

TEST(DescribeMotions, ReadsColumnsInAnyOrder) {
  std::vector<MotionFile> motions = list_motions(kPaths);
  describe_motions(
      motions, "fps,description,repo,file\r\n30,\"walk, \"\"slow\"\"\",r,b/02_01.amc\r\n,run,r,x.bvh\n\n,no,r,1.amc\n",
      "list.csv");
  EXPECT_EQ(motions[1].description, "walk, \"slow\"");
  EXPECT_EQ(motions[1].fps, 30.F);
  EXPECT_EQ(motions[0].description, "run");
  EXPECT_EQ(motions[2].description, "02_07") << "half a name is no name";
  EXPECT_EQ(motions[2].fps, 120.F);
}

TEST(DescribeMotions, NamesLineAndReasonOfErrors) {
  const auto reading = [](const char* csv) {
    return [csv] {
      std::vector<MotionFile> motions;
      describe_motions(motions, csv, "list.csv");
    };
  };
  EXPECT_THAT(reading("a,b\n"),
              ThrowsMessage<Error>(HasSubstr("list.csv:1: expected a first line that names columns")));
  EXPECT_THAT(reading(""), ThrowsMessage<Error>(HasSubstr("list.csv:1:")));
  EXPECT_THAT(reading("file,description\na,b\na\n"),
              ThrowsMessage<Error>("list.csv:3: expected 2 fields as in the first line, found 1"));
  EXPECT_THAT(reading("file,description\na,\"b\n"), ThrowsMessage<Error>("list.csv:2: expected a closing quote"));
  EXPECT_THAT(reading("file,description,fps\na,b,nan\n"), ThrowsMessage<Error>(HasSubstr("list.csv:2: fps: expected")));
  EXPECT_THAT(reading("file,description,fps\na,b,-3\n"), ThrowsMessage<Error>(HasSubstr("found \"-3\"")));
}

TEST(ChooseMotions, ComparesWordsWithoutRegardToCase) {
  std::vector<MotionFile> motions(4);
  motions[0] = {"1", "", "Walk and wave", 30.F};
  motions[1] = {"2", "", "cartwheel", 30.F};
  motions[2] = {"3", "", "run", 30.F};
  motions[3] = {"4", "", "dance - sideways arabesque", 30.F};
  EXPECT_THAT(paths_of(choose_motions(motions, {})), ElementsAre("1", "3"));
  EXPECT_THAT(paths_of(choose_motions(motions, {{"WALK"}, {}})), ElementsAre("1"));
  EXPECT_THAT(paths_of(choose_motions(motions, {{"walk", "run"}, {"wave"}})), ElementsAre("3"));
  EXPECT_THAT(paths_of(choose_motions(motions, {{}, {}})), ElementsAre("1", "2", "3", "4"));
}

}  // namespace
}  // namespace vesalius::synth
