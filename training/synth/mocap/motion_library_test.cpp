#include "synth/mocap/motion_library.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "synth/mocap/retarget.h"
#include "synth/mocap/thin_poses.h"
#include "synth/pose/judge_pose.h"
#include "synth/pose/pose_sampler.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;
using testing::ThrowsMessage;

constexpr float kDegree = 3.14159265F / 180.F;

/// Returns a skeleton in a T with all bones of asf_amc.toml, each with three dofs.
std::string t_skeleton() {
  const std::map<std::string, std::pair<std::string, std::string>> bones = {
      {"upperback", {"root", "0 1 0"}},      {"thorax", {"upperback", "0 1 0"}},    {"lowerneck", {"thorax", "0 1 0"}},
      {"upperneck", {"lowerneck", "0 1 0"}}, {"head", {"upperneck", "0 1 0"}},      {"lclavicle", {"thorax", "1 0 0"}},
      {"lhumerus", {"lclavicle", "1 0 0"}},  {"lradius", {"lhumerus", "1 0 0"}},    {"lhand", {"lradius", "1 0 0"}},
      {"rclavicle", {"thorax", "-1 0 0"}},   {"rhumerus", {"rclavicle", "-1 0 0"}}, {"rradius", {"rhumerus", "-1 0 0"}},
      {"rhand", {"rradius", "-1 0 0"}},      {"lfemur", {"root", "0 -1 0"}},        {"ltibia", {"lfemur", "0 -1 0"}},
      {"lfoot", {"ltibia", "0 0 1"}},        {"rfemur", {"root", "0 -1 0"}},        {"rtibia", {"rfemur", "0 -1 0"}},
      {"rfoot", {"rtibia", "0 0 1"}}};
  std::string text =
      ":units\nangle deg\n:root\norder TX TY TZ RX RY RZ\naxis XYZ\nposition 0 0 0\norientation 0 0 0\n:bonedata\n";
  std::string links = ":hierarchy\nbegin\n";
  for (const auto& [name, bone] : bones) {
    text += "begin\nname " + name + "\ndirection " + bone.second + "\nlength 1\naxis 0 0 0 XYZ\ndof rx ry rz\nend\n";
    links += bone.first + " " + name + "\n";
  }
  return text + links + "end\n";
}

/// Files by their paths, with the number of times that each was read.
struct Files {
  std::map<std::string, std::string> text;
  std::map<std::string, int> reads;

  ReadText reader() {
    return [this](const std::string& path) {
      ++reads[path];
      const auto found = text.find(path);
      if (found == text.end()) throw Error(path + ": cannot be opened");
      return found->second;
    };
  }
};

Files some_files() {
  Files files;
  files.text["1.asf"] = t_skeleton();
  files.text["1_a.amc"] = ":DEGREES\n1\nlradius 0 -40 0\n2\nlradius 0 -42 0\n3\nlradius 0 -50 0\n";
  files.text["1_b.amc"] =
      "1\nlhumerus 0 0 -80\nrhumerus 0 0 80\n2\nlhumerus 0 -100 0\nlradius 0 -140 0\n";  // this puts a hand inside the
                                                                                         // chest
  files.text["2_a.amc"] = "1\nroot 0 0 0 0 0 0\n";
  return files;
}

std::vector<MotionFile> listed(const Files& files) {
  std::vector<std::string> paths;
  for (const auto& [path, text] : files.text) paths.push_back(path);
  std::vector<MotionFile> motions = list_motions(paths);
  for (MotionFile& motion : motions) motion.fps = 30.F;
  return motions;
}

TEST(PoseLibrary, LoadsAndThinsPosesAndNamesTheirMotions) {
  Files files = some_files();
  files.text.erase("2_a.amc");
  const PoseLibrary library = load_pose_library(listed(files), files.reader(), {.every = 1, .min_angle_deg = 5.F});
  EXPECT_THAT(library.skipped, SizeIs(0));
  ASSERT_THAT(library.poses, SizeIs(3)) << "40 and 50 degrees, and arms that hang";
  const PoseLibrary all = load_pose_library(listed(files), files.reader(), {.every = 1, .min_angle_deg = 0.F});
  EXPECT_THAT(all.poses, SizeIs(4)) << "of five frames one intersects itself";
  EXPECT_NEAR(largest_angle(library.poses[0].pose, library.poses[1].pose), 10.F * kDegree, 1e-3F);
  EXPECT_EQ(library.poses[2].posture, Posture::standing);
  EXPECT_EQ(files.reads["1.asf"], 2) << "a skeleton is read once for each library";
}

TEST(PoseLibrary, TakesEveryNthFrame) {
  Files files = some_files();
  files.text.erase("2_a.amc");
  const PoseLibrary library = load_pose_library(listed(files), files.reader(), {.every = 2, .min_angle_deg = 0.F});
  EXPECT_THAT(library.poses, SizeIs(3)) << "frames 1 and 3 of the first, 1 of the second";
}

TEST(PoseLibrary, TakesEvery4thFrameOfRecordingsAt120Hertz) {
  Files slow, fast;
  slow.text["1.asf"] = fast.text["subjects/1/1.asf"] = t_skeleton();
  for (int i = 0; i < 17; ++i) {
    const std::string frame = "\nlradius 0 -" + std::to_string(5 * i) + " 0\n";
    fast.text["subjects/1/1_a.amc"] += std::to_string(i + 1) + frame;
    if (i % 4 == 0) slow.text["1_a.amc"] += std::to_string(i / 4 + 1) + frame;
  }
  std::vector<MotionFile> recorded = listed(fast);
  recorded[0].fps = MotionFile{}.fps;
  const PoseLibrary library = load_pose_library(recorded, fast.reader(), {.every = 2, .min_angle_deg = 0.F});
  const PoseLibrary expected = load_pose_library(listed(slow), slow.reader(), {.every = 2, .min_angle_deg = 0.F});
  ASSERT_EQ(library.poses.size(), 3U);
  ASSERT_EQ(expected.poses.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(largest_angle(library.poses[i].pose, expected.poses[i].pose), 0.F) << i;
  }
}

TEST(PoseLibrary, LeavesOutHandsTurnedBackToFront) {
  Files files = some_files();
  files.text = {{"1.asf", t_skeleton()}, {"1_a.amc", "1\nlhand 150 0 0\n2\nlhand 60 0 0\n"}};
  const PoseLibrary library = load_pose_library(listed(files), files.reader(), {.every = 1});
  EXPECT_THAT(library.poses, SizeIs(1));
}

TEST(PoseLibrary, SkipsUnusableFilesAndSaysWhy) {
  Files files = some_files();
  files.text["1_c.amc"] = "1\nlradius 0 nan 0\n";
  const PoseLibrary library = load_pose_library(listed(files), files.reader(), {});
  EXPECT_THAT(library.skipped,
              testing::ElementsAre(HasSubstr("1_c.amc:2: expected"),
                                   "2_a.amc: no skeleton: expected an .asf beside it with the beginning of its name"));
  EXPECT_FALSE(library.poses.empty());
}

TEST(PoseLibrary, RefusesFilesOfWhichNoneIsUsable) {
  Files files;
  files.text["2_a.amc"] = "1\n";
  EXPECT_THAT([&] { load_pose_library(listed(files), files.reader(), {}); },
              ThrowsMessage<Error>(HasSubstr("none of 1 motions can be used: 2_a.amc: no skeleton")));
  EXPECT_THROW(load_pose_library(listed(files), files.reader(), {.every = 0}), UsageError);
  EXPECT_TRUE(load_pose_library({}, files.reader(), {}).poses.empty());
}

/// Returns the angle in degrees between the directions of a bone in two poses.
float apart(const Pose& a, const Pose& b, Bone bone) {
  const auto direction = [&](const Pose& pose) {
    return (world_rotations(pose)[index(bone)] * rest_direction(bone)).eval();
  };
  return std::acos(std::clamp(direction(a).dot(direction(b)), -1.F, 1.F)) / kDegree;
}

/// Compares the BVH of a clip with its AMC. The BVH begins with a T pose, which is skipped, and is three quarters of a
/// frame late. Returns the median of the worst bone.
float median_difference_deg(const std::vector<Pose>& bvh, const std::vector<Pose>& amc) {
  std::array<std::vector<float>, kBoneCount> differences;
  for (std::size_t f = 0; f + 1 < amc.size() && f < bvh.size(); ++f) {
    for (std::size_t b = 0; b < kBoneCount; ++b) {
      Pose between;
      for (std::size_t j = 0; j < kBoneCount; ++j) between.local[j] = amc[f].local[j].slerp(0.75F, amc[f + 1].local[j]);
      differences[b].push_back(apart(bvh[f], between, static_cast<Bone>(b)));
    }
  }
  float worst = 0.F;
  for (std::vector<float>& d : differences) {
    std::ranges::nth_element(d, d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2));
    worst = std::max(worst, d[d.size() / 2]);
  }
  return worst;
}

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<Pose> poses_of(const MotionFile& file) {
  const std::string text = slurp(file.path);
  const Motion motion = file.skeleton.empty()
                            ? parse_bvh(text, file.path)
                            : parse_amc(text, file.path, parse_asf(slurp(file.skeleton), file.skeleton), file.fps);
  return retarget(motion, find_convention(motion, builtin_conventions()));
}

TEST(PoseLibrary, IsPlausibleForRealMotions) {
  const char* given = std::getenv("VESALIUS_SHARED");
  const fs::path shared = given != nullptr ? fs::path(given) : fs::path(VESALIUS_SOURCE_DIR) / "../shared";
  const fs::path archive = shared / "assets/mocap.tar.xz";
  if (!fs::exists(archive)) GTEST_SKIP() << "no motion captures: set VESALIUS_SHARED";
  const fs::path folder = fs::path(testing::TempDir()) / ("vesalius_pose_library_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string command = "tar -xJf '" + archive.string() + "' -C '" + folder.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;  // NOLINT(concurrency-mt-unsafe)
  std::vector<std::string> paths;
  std::string manifest;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) paths.push_back(entry.path().string());
    if (entry.path().filename() == "manifest.csv") manifest = entry.path().string();
  }
  std::vector<MotionFile> motions = list_motions(paths);
  describe_motions(motions, slurp(manifest), manifest);

  std::map<std::string, std::vector<const MotionFile*>> by_clip;
  for (const MotionFile& motion : motions) by_clip[fs::path(motion.path).stem().string()].push_back(&motion);
  int compared = 0;
  for (const auto& [clip, files] : by_clip) {
    if (files.size() != 2) continue;
    ++compared;
    EXPECT_LT(median_difference_deg(poses_of(*files[1]), poses_of(*files[0])), 1.5F) << clip;
  }
  EXPECT_GE(compared, 10);

  const std::vector<MotionFile> chosen = choose_motions(motions, {});
  EXPECT_GT(chosen.size(), 300U);
  EXPECT_LT(chosen.size(), motions.size());
  const PoseLibrary library = load_pose_library(chosen, slurp, {.every = 4});
  EXPECT_LT(library.skipped.size(), 10U);
  EXPECT_GT(library.poses.size(), 3000U);
  std::map<Posture, int> postures;
  for (const SampledPose& p : library.poses) ++postures[p.posture];
  EXPECT_GT(postures[Posture::lying], 50) << "HDM05 lies down";
  EXPECT_GT(postures[Posture::standing], static_cast<int>(library.poses.size()) / 2);

  const MovementLibrary movements = load_movements(chosen, slurp);
  EXPECT_GT(movements.gaits.size(), 50U) << "CMU walks";
  EXPECT_GT(movements.stays.size(), 40U);
  EXPECT_GE(movements.lie_downs.size(), 5U);
  for (const Gait& gait : movements.gaits) {
    EXPECT_GT(gait.period_s, 0.6F);
    EXPECT_LT(gait.speed(), 2.4F);
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace vesalius::synth
