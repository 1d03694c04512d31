#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "run_program.h"
#include "small_frames.h"
#include "vesalius/body_model.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Two small datasets that are made once for all tests, and a folder for each test, which is removed afterwards.
class TrainProgram : public testing::Test {
 public:
  static void SetUpTestSuite() {
    fs::remove_all(shared());
    fs::create_directories(shared());
    expect_done(run_program(synth("--count 60 --seed 5 --out " + data() + kEasyFrames)));
  }
  static void TearDownTestSuite() { fs::remove_all(shared()); }

 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / fmt::format("vesalius_train_{}_{}", ::getpid(), test->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static std::string data() { return (shared() / "data").string(); }
  static std::string synth(const std::string& more) { return "synth -q " + more + kSmallFrames; }
  /// Returns a command that grows a forest in well under a second.
  static std::string train(const std::string& more, int trees = 3) {
    return fmt::format("train --trees {} --hard-trees 1 --depth 8 --candidates 20 --pixels 200 --held-out-share 0.1 {}",
                       trees, more);
  }
  static void expect_done(const Outcome& run) { EXPECT_EQ(run.exit_code, 0) << run.err; }

  /// Returns a folder of depth pictures of rooms without people.
  std::string backgrounds() const {
    const std::string folder = path("empty");
    expect_done(run_program(synth("--count 5 --seed 9 --format folder --out " + folder + kEmptyFrames)));
    return folder;
  }
  std::string recipe() const {
    const std::string file = path("recipe.toml");
    write_file_atomically(file,
                          "sensor.width = 80\nsensor.height = 60\nbody.kind = 'builtin'\nbody.count = 2\n"
                          "pose.captured = 0.0\n");
    return file;
  }

  void refused(const std::string& arguments, int exit_code, const std::string& reason) const {
    SCOPED_TRACE(arguments);
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(reason));
  }

 private:
  static fs::path shared() { return fs::path(testing::TempDir()) / fmt::format("vesalius_train_{}", ::getpid()); }
  fs::path folder_;
};

TEST_F(TrainProgram, TrainsOnTheProcessorWhereAnyDeviceWillDo) {
  const auto bytes_from = [&](const std::string& device) {
    const std::string model = path(device + ".forest");
    const Outcome run = run_program(train("--data " + data() + " -q --device " + device + " --out " + model));
    expect_done(run);
    EXPECT_THAT(run.err, AnyOf(IsEmpty(), HasSubstr("note: cuda: "))) << device;
    return read_file(model);
  };
  EXPECT_EQ(bytes_from("auto"), bytes_from("cpu"));
}

TEST_F(TrainProgram, RefusesDevicesThatAreNotThere) {
  const std::string command = train("--data " + data() + " --out " + path("m.forest"));
  refused(command + " --device gpu", 2, "device \"gpu\" is not known to this build");
  refused(command + " --device cuda:999", 1, "vesalius: cuda");
  refused(command + " --device cuda:0,gpu:1", 2, "device \"cuda:0,gpu:1\" is not known to this build");
  refused(command + " --device cuda:998,cuda:999", 1, "vesalius: cuda");
  refused(command + " --device cuda --on local:2", 2, "--on expects no --device");
  EXPECT_FALSE(fs::exists(path("m.forest")));
  EXPECT_FALSE(fs::exists(path("m.forest.work"))) << "before anything is read";
}

TEST_F(TrainProgram, WritesAModelThatDetectLoads) {
  const Outcome run =
      run_program(train("--data " + data() + " --background " + backgrounds() + " --out " + path("m.forest")));
  expect_done(run);
  EXPECT_GT(accuracy_in(run.err), 0.2) << "chance is 0.04; " << run.err;
  const Forest forest = load_model(path("m.forest")).forest;
  EXPECT_EQ(forest.trees.size(), 3U);
  EXPECT_TRUE(forest.has_background);
  EXPECT_THAT(forest.recipe, HasSubstr("candidates = 20\n"));
  EXPECT_THAT(forest.recipe, HasSubstr("# background 1: 5 frames, sha256 "));
  EXPECT_THAT(forest.recipe, HasSubstr("# data 1: 60 frames, seed 5, hash "));
  EXPECT_THAT(forest.recipe, HasSubstr("#   body.kind = 'builtin'\n"));
  EXPECT_THAT(forest.recipe, Not(HasSubstr(testing::TempDir()))) << "folders are the user's own";
  EXPECT_FALSE(fs::exists(path("m.forest.work")));
  expect_done(
      run_program("detect -q " + path("empty") + " --json " + path("people.jsonl") + " -m " + path("m.forest")));
}

TEST_F(TrainProgram, TrainsTheSameModelFromItsRecipe) {
  expect_done(run_program(train("-q --data " + data() + " --out " + path("a.forest"))));
  write_file_atomically(path("again.toml"), load_model(path("a.forest")).forest.recipe);
  expect_done(
      run_program("train -q --options " + path("again.toml") + " --data " + data() + " --out " + path("b.forest")));
  EXPECT_EQ(bytes_of(path("a.forest")), bytes_of(path("b.forest")));
}

TEST_F(TrainProgram, TrainsAlikeOnRenderedFramesAndADataset) {
  expect_done(run_program("synth -q --recipe " + recipe() + " --seed 5 --count 30 --out " + path("d")));
  expect_done(run_program(train("-q --data " + path("d") + " --out " + path("a.forest"))));
  expect_done(run_program(train("-q --recipe " + recipe() + " --recipe-seed 5 --count 30 --out " + path("b.forest"))));
  EXPECT_EQ(bytes_of(path("a.forest")), bytes_of(path("b.forest")));
}

// Labels: threads
TEST_F(TrainProgram, WritesTheSameBytesForAnyNumberOfThreads) {
  expect_done(run_program(train("-q --threads 1 --data " + data() + " --out " + path("one.forest"))));
  expect_done(run_program(train("-q --threads 4 --data " + data() + " --out " + path("four.forest"))));
  ASSERT_FALSE(bytes_of(path("one.forest")).empty());
  EXPECT_EQ(bytes_of(path("one.forest")), bytes_of(path("four.forest")));
}

TEST_F(TrainProgram, ContinuesAfterAKillWithTheSameBytes) {
  const std::string command = train("-q --threads 1 --data " + data() + " --out ", 12);
  expect_done(run_program(command + path("whole.forest")));
  // The program is killed when the forest's second tree appears, however slow the machine is.
  const std::string work = path("killed.forest") + ".work";
  run_program(command + path("killed.forest") + " & pid=$!; i=0; while [ $i -lt 6000 ] && ! [ -e " + work +
              "/tree-0001.forest ]; do sleep 0.005; i=$((i + 1)); done; kill -9 $pid; wait $pid");
  ASSERT_TRUE(fs::exists(work + "/tree-0001.forest"));
  ASSERT_FALSE(fs::exists(work + "/tree-0011.forest")) << "killed before the end";
  const auto kept = fs::last_write_time(work + "/tree-0000.forest");
  write_file_atomically(work + "/tree-0001.forest", "damaged");
  const Outcome more = run_program(command + path("killed.forest") + " --min-gain 0.002");
  EXPECT_EQ(more.exit_code, 1);
  EXPECT_THAT(more.err, HasSubstr("`min-gain = 0.001` before, now `min-gain = 0.002`"));
  EXPECT_EQ(fs::last_write_time(work + "/tree-0000.forest"), kept);
  expect_done(run_program(command + path("killed.forest")));
  EXPECT_EQ(bytes_of(path("killed.forest")), bytes_of(path("whole.forest")));
  EXPECT_FALSE(fs::exists(work));
}

TEST_F(TrainProgram, KeepsFinishedTreesWhenInterrupted) {
  const std::string work = path("m.forest") + ".work";
  const std::string command = train("--threads 1 --data " + data() + " --out " + path("m.forest"), 200);
  // A background job ignores Ctrl-C, so the signal is that of `kill`.
  run_program(command + " 2>" + path("said") + " & pid=$!; i=0; while [ $i -lt 6000 ] && ! [ -e " + work +
              "/tree-0001.forest ]; do sleep 0.005; i=$((i + 1)); done; kill -TERM $pid; wait $pid; echo $? >" +
              path("status"));
  EXPECT_EQ(bytes_of(path("status")), "1\n");
  EXPECT_THAT(bytes_of(path("said")), HasSubstr("the same command goes on"));
  EXPECT_TRUE(fs::exists(work + "/tree-0001.forest"));
  EXPECT_FALSE(fs::exists(path("m.forest")));
}

TEST_F(TrainProgram, DiscardsOtherTreesOnRestart) {
  fs::create_directories(path("m.forest.work"));
  write_file_atomically(path("m.forest.work/recipe.toml"), "trees = 5\n");
  const std::string command = train("-q --data " + data() + " --out " + path("m.forest"));
  refused(command, 1, "--restart");
  expect_done(run_program(command + " --restart"));
  EXPECT_TRUE(fs::exists(path("m.forest")));
}

TEST_F(TrainProgram, EstimatesTimeAndMemoryWithoutWriting) {
  const Outcome run = run_program(train("--estimate --data " + data()));
  expect_done(run);
  for (const char* line : {"frames ", "samples ", "evaluations ", "trees ", "time ", "memory "}) {
    EXPECT_THAT(run.out, HasSubstr(line));
  }
}

TEST_F(TrainProgram, WritesAReportWithTablesAndPlots) {
  expect_done(
      run_program(train("-q --curves --data " + data() + " --report " + path("r") + " --out " + path("m.forest"))));
  const std::string page = bytes_of(path("r/report.html"));
  for (const char* part :
       {"Confusion matrix", "l_upper_arm", "Million evaluations per core-second", "candidates = 20"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
  for (const char* plot : {"first trees together", "cut at a level", "frames learned from", "candidates of a node"}) {
    EXPECT_THAT(page,
                ContainsRegex("\"caption\":\"Accuracy [a-z ]*" + std::string(plot) + "[^\"]*\",\"kind\":\"plot\""));
  }
}

TEST_F(TrainProgram, ReportsBadInputInOneLine) {
  const std::string out = " --out " + path("x.forest");
  refused(train(out), 2, "--data or --recipe");
  refused(train("--data " + data()), 2, "--out");
  refused(train("--data " + data() + " --out " + path("")), 2, "name of a file");
  refused(train("--data " + path("none") + out), 1, "none");
  refused(train("--recipe " + recipe() + out), 2, "--count");
  refused(train("--data " + data() + " --curves" + out), 2, "--report");
  refused("train --held-out-share 0 --data " + data() + " --report " + path("report") + out, 2,
          "held-out-share above 0");
  refused(train("--data " + data() + " --min-gain 11" + out), 2, "min-gain");
  refused(train("--data " + data() + " --background-share 0 --background " + data() + out), 2, "background class");
  refused(train("--data " + data() + " --background " + path("nowhere") + out), 1, "nowhere");
  write_file_atomically(path("broken.png"), "no picture");
  refused(train("--data " + data() + " --background " + path("broken.png") + " --fx 60" + out), 1, "broken.png");
  refused("train --data " + data() + " --memory 0.01" + out, 1, "--memory allows 0.01: expected --memory 0.");
  refused("train --data " + data() + " --memory 0.5 --pixels 100000" + out, 1, "fewer --pixels, or --on");
  std::string other(paper_body().toml);
  other.replace(other.find("\"l_foot\""), 8, "\"l_fuss\"");
  for (std::size_t at = 0; (at = other.find("\"l_foot\"")) != std::string::npos;) other.replace(at, 8, "\"l_fuss\"");
  write_file_atomically(path("other.toml"), other);
  refused(train("--data " + data() + " --body " + path("other.toml") + out), 1,
          "body part 0 is l_foot, expected l_fuss");
  EXPECT_FALSE(fs::exists(path("x.forest")));
  EXPECT_FALSE(fs::exists(path("x.forest.work")));
}

TEST_F(TrainProgram, RefusesFramesWithoutPeople) {
  expect_done(run_program(synth("--count 4 --out " + path("d") + kEmptyFrames)));
  refused(train("-q --data " + path("d") + " --out " + path("x.forest")), 1, "no person in any of 4 frames");
}

TEST_F(TrainProgram, LearnsTheLeavesOfItsTreesTogether) {
  const std::string all = path("all.forest"), trees = path("trees.forest");
  const Outcome run = run_program(train("--leaf-rounds 3 --data " + data() + " --out " + all));
  expect_done(run);
  EXPECT_THAT(run.err, HasSubstr("leaves: 3 of 3 rounds"));
  expect_done(run_program(train("-q --data " + data() + " --out " + trees)));
  const Forest learned = load_model(all).forest, grown = load_model(trees).forest;
  EXPECT_GT(learned.logit_unit, 0.F);
  EXPECT_EQ(grown.logit_unit, 0.F);
  ASSERT_EQ(learned.trees.size(), grown.trees.size());
  for (std::size_t t = 0; t < grown.trees.size(); ++t) {
    EXPECT_EQ(learned.trees[t].nodes, grown.trees[t].nodes);
    EXPECT_FALSE(learned.trees[t].logits.empty());
    EXPECT_TRUE(std::ranges::all_of(learned.trees[t].leaves, [](const TreeLeaf& leaf) { return leaf == TreeLeaf{}; }));
    EXPECT_TRUE(std::ranges::none_of(grown.trees[t].leaves, [](const TreeLeaf& leaf) { return leaf == TreeLeaf{}; }));
  }
  refused("train --leaf-rounds 3 --leaf-headings 5 --data " + data() + " --out " + path("m.forest"), 2,
          "leaf-headings 5, expected 0 or 8");
}

}  // namespace
}  // namespace vesalius
