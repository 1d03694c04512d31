#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "dataset/labelled_dataset.h"
#include "io/files/atomic_file.h"
#include "io/files/test_files.h"
#include "run_program.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SynthProgram : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_ / name; }

  /// Returns a command that makes small frames with few built-in bodies.
  static std::string synth(const std::string& more) {
    return "synth -q --sensor.width 80 --sensor.height 60 --body.kind builtin --body.count 2 --seed 5 " + more;
  }
  static void expect_done(const Outcome& run) { EXPECT_EQ(run.exit_code, 0) << run.err; }

  /// Returns the name and bytes of every file of a folder.
  static std::vector<std::pair<std::string, std::string>> contents(const std::string& folder) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) {
        files.emplace_back(fs::relative(entry.path(), folder).string(), bytes_of(entry.path().string()));
      }
    }
    std::ranges::sort(files);
    return files;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(SynthProgram, WritesFramesThatTheReaderReads) {
  expect_done(run_program(synth("--count 12 --out " + path("d"))));
  const DatasetReader reader(path("d"));
  ASSERT_EQ(reader.size(), 12);
  const LabelledFrame frame = reader.read(11);
  EXPECT_EQ(frame.frame.camera.width, 80);
  EXPECT_EQ(frame.labels.height(), 60);
  EXPECT_EQ(frame.frame.name, "00000011");
}

// Labels: threads
TEST_F(SynthProgram, WritesTheSameBytesForAnyNumberOfThreads) {
  expect_done(run_program(synth("--count 20 --threads 1 --out " + path("one"))));
  expect_done(run_program(synth("--count 20 --threads 8 --out " + path("eight"))));
  EXPECT_EQ(contents(path("one")), contents(path("eight")));
}

TEST_F(SynthProgram, ContinuesAfterAKillWithTheSameBytes) {
  const std::string frames = "--count 300 --shard 10 --threads 1 --out ";
  expect_done(run_program(synth(frames + path("whole"))));
  // The program is killed when the first shard appears, however slow the machine is.
  const std::string kill = synth(frames + path("killed")) + " & pid=$!; i=0; while [ $i -lt 600 ] && ! ls " +
                           path("killed") +
                           " 2>/dev/null | grep -q shard; do sleep 0.05; i=$((i + 1)); done; kill -9 $pid; wait $pid";
  run_program(kill);
  ASSERT_LT(contents(path("killed")).size(), contents(path("whole")).size()) << "killed before the end";
  expect_done(run_program(synth(frames + path("killed"))));
  EXPECT_EQ(contents(path("killed")), contents(path("whole")));
}

TEST_F(SynthProgram, RefusesToContinueWithAnotherRecipe) {
  expect_done(run_program(synth("--count 4 --out " + path("d"))));
  const auto before = contents(path("d"));
  const Outcome run = run_program(synth("--count 8 --people.none 1 --out " + path("d")));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("another recipe"));
  EXPECT_EQ(contents(path("d")), before);
}

TEST_F(SynthProgram, ExportsFoldersThatDetectReads) {
  expect_done(run_program(synth("--count 3 --format folder --out " + path("f"))));
  const auto source = open_source(path("f"));
  ASSERT_EQ(source->size(), 3);
  const auto frame = source->next();
  EXPECT_EQ(frame->depth.width(), 80);
  EXPECT_FALSE(frame->colour.empty());
}

TEST_F(SynthProgram, MakesASingleFrameAgain) {
  expect_done(run_program(synth("--count 12 --out " + path("d"))));
  expect_done(run_program(synth("--first 11 --count 1 --format folder --out " + path("alone"))));
  const LabelledFrame in_a_row = DatasetReader(path("d")).read(11);
  const auto alone = open_source(path("alone"))->next();
  EXPECT_EQ(alone->name, "00000011");
  EXPECT_EQ(alone->depth, in_a_row.frame.depth);
  EXPECT_EQ(read_png8(path("alone/labels/00000011.png")), in_a_row.labels);
}

TEST_F(SynthProgram, MakesClips) {
  const std::string clips = "--clip 0.5 --rate 8 --count 2 --no-sensor.colour ";
  expect_done(run_program(synth(clips + "--threads 1 --out " + path("one"))));
  expect_done(run_program(synth(clips + "--threads 4 --out " + path("four"))));
  EXPECT_EQ(contents(path("one")), contents(path("four")));
  const DatasetReader reader(path("one"));
  ASSERT_EQ(reader.size(), 8);
  EXPECT_EQ(reader.info().clips, (ClipLayout{4, 8.0}));
  const LabelledFrame frame = reader.read(5);
  EXPECT_EQ(frame.frame.name, "0001_000001");
  EXPECT_EQ(frame.frame.time_s, 0.125);

  expect_done(run_program(
      synth("--clip 0.5 --rate 8 --first 1 --count 1 --no-sensor.colour --format folder --out " + path("alone"))));
  EXPECT_EQ(read_png8(path("alone/labels/0001_000001.png")), frame.labels);
  const auto pictures = open_source(path("alone"));
  pictures->next();
  EXPECT_EQ(pictures->next()->time_s, 0.125) << "of mere pictures";
  expect_done(run_program(synth("--clip 0.5 --preview 3 --out " + path("clip.png"))));
  EXPECT_GT(read_colour(path("clip.png")).width(), 300);
}

TEST_F(SynthProgram, WritesAPreviewPicture) {
  expect_done(run_program(synth("--preview 6 --out " + path("sheet.png"))));
  const ColourImage sheet = read_colour(path("sheet.png"));
  EXPECT_GT(sheet.width(), 300);
}

TEST_F(SynthProgram, ReadsTheRecipesThatItWrites) {
  const Outcome options = run_program("options synth");
  expect_done(options);
  EXPECT_THAT(options.out, HasSubstr("sensor.preset = 'kinect-v1'"));
  expect_done(run_program("options synth > " + path("r.toml")));
  expect_done(run_program("synth -q --recipe " + path("r.toml") +
                          " --sensor.width 80 --sensor.height 60 --body.kind builtin --body.count 2 --seed 5 --count 4 "
                          "--out " +
                          path("a")));
  expect_done(run_program(synth("--count 4 --out " + path("b"))));
  EXPECT_EQ(contents(path("a")), contents(path("b")));
}

TEST_F(SynthProgram, ReportsBadInputInOneLine) {
  const auto refused = [&](const std::string& arguments, int exit_code, const std::string& reason) {
    SCOPED_TRACE(arguments);
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(reason));
  };
  refused("synth", 2, "expected one of --count, --preview and --like");
  refused("synth --preview 1 --like nowhere", 2, "expected one of --count, --preview and --like");
  refused("synth --like nowhere", 1, "nowhere");
  refused("synth --like nowhere --clip 2", 2, "--like expects none of --clip");
  refused(synth("--count 3"), 2, "--out");
  refused(synth("--count 3 --preset kinekt --out " + path("x")), 2, "kinect-v1");
  refused(synth("--count 3 --mounting roof --out " + path("x")), 2, "ceiling");
  refused(synth("--count 0 --out " + path("x")), 2, "--count");
  refused(synth("--clip 0 --count 1 --out " + path("x")), 2, "clips of 0 seconds");
  refused(synth("--clip -3 --count 1 --out " + path("x")), 2, "clips of -3 seconds");
  refused(synth("--clip 1 --rate -5 --count 1 --out " + path("x")), 2, "-5 frames a second");
  refused(synth("--rate 30 --count 1 --out " + path("x")), 2, "--rate expects --clip");
  refused(synth("--clip 1 --first 2 --count 1 --out " + path("x")), 2, "--first expects");
  refused(synth("--clip 600 --count 100000000 --out " + path("x")), 2, "frames in all");
  refused(synth("--clip 1 --clip.moving-share 2 --count 1 --out " + path("x")), 2, "clip.moving-share");
  refused("evaluate -m none.forest --clip 1 " + path("d"), 2, "--clip expects --recipe");
  refused(synth("--count 3 --people.one -1 --out " + path("x")), 2, "people.one");
  refused(synth("--count 3 --recipe " + path("none.toml") + " --out " + path("x")), 1, "none.toml");
  std::string deep = "a";  // so many nested tables that freeing them would exhaust the stack
  for (int i = 0; i < 200000; ++i) deep += ".a";
  write_file_atomically(path("deep.toml"), deep + " = 1\n");
  refused(synth("--count 3 --recipe " + path("deep.toml") + " --out " + path("x")), 1, "deep.toml");
  refused("synth -q --body.kind makehuman --count 1 --assets " + path("nowhere") + " --out " + path("x"), 1,
          "vesalius assets makehuman");
  EXPECT_FALSE(fs::exists(path("x")));
}

TEST_F(SynthProgram, NeverSubstitutesMissingAssetsSilently) {
  const std::string small = "sensor.width = 80\nsensor.height = 60\nbody.count = 2\n";
  write_file_atomically(path("any.toml"), small);
  write_file_atomically(path("moving.toml"), small + "pose.captured = 0.5\n");
  const std::string nowhere = " --assets " + path("nowhere");
  const std::string model = " -m " VESALIUS_SOURCE_DIR "/data/models/small.forest";
  const std::string evaluate = "evaluate -q --count 2" + nowhere + model + " --recipe ";

  const Outcome refused = run_program(evaluate + path("moving.toml"));
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("`vesalius assets mocap`"));
  EXPECT_EQ(
      run_program("synth -q --count 2 --recipe " + path("moving.toml") + nowhere + " --out " + path("x")).exit_code, 1);

  expect_done(run_program(evaluate + path("any.toml") + " --json " + path("r.json")));
  EXPECT_THAT(bytes_of(path("r.json")), HasSubstr("makehuman is not there, the built-in body instead"));
  expect_done(run_program("synth -q --count 2 --recipe " + path("any.toml") + nowhere + " --out " + path("d")));
  EXPECT_THAT(DatasetReader(path("d")).info().recipe, HasSubstr("# mocap is not there, sampled poses instead\n"));
}

}  // namespace
}  // namespace vesalius
