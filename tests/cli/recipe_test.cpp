#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "io/files/atomic_file.h"
#include "run_program.h"
#include "small_world.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

/// A recipe whose model is made in three seconds.
constexpr const char* kRecipe = R"([synth]
sensor.width = 96
sensor.height = 72
sensor.colour = false
body.kind = "builtin"
body.count = 4
pose.captured = 0.0
[forest]
frames = "train"
trees = 3
hard-trees = 1
depth = 12
candidates = 20
pixels = 200
leaf-rounds = 3
[context]
frames = "one, two"
step = 2
[judge]
frames = "one, two"
[frames.train]
count = 80
seed = 5
[frames.one]
count = 30
seed = 6
[frames.two]
looks = "empty"
count = 20
seed = 7
[look.empty]
people.none = 0.5
)";

class ModelRecipe : public SmallWorld {
 protected:
  void SetUp() override {
    fs::remove_all(path("recipe"));
    fs::create_directories(path("recipe"));
  }

  static std::string in(const std::string& name) { return path("recipe/" + name); }
  static std::string recipe(const std::string& text = kRecipe) {
    write_file_atomically(in("r.toml"), text);
    return in("r.toml");
  }
  static std::string with(std::string text, const std::string& old, const std::string& now) {
    return text.replace(text.find(old), old.size(), now);
  }
  static Outcome make(const std::string& recipe, const std::string& model, const std::string& more = "") {
    return run_program("train --recipe " + recipe + " --out " + in(model) + more);
  }
  static std::string made(const std::string& recipe, const std::string& model, const std::string& more = "") {
    const Outcome run = make(recipe, model, more + " -q");
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return bytes_of(in(model));
  }
  /// Makes the model, but kills the program when `file` of the working folder appears. Returns whether that was before
  /// the end, which a busy machine may miss.
  static bool make_until(const std::string& recipe, const std::string& model, const std::string& file) {
    const std::string place = in(model) + ".work/" + file;
    make(recipe, model,
         " -q --threads 1 & pid=$!; i=0; while [ $i -lt 12000 ] && ! [ -e " + place +
             " ] && kill -0 $pid 2>/dev/null; do sleep 0.005; i=$((i + 1)); done; kill -9 $pid; wait $pid");
    EXPECT_TRUE(fs::exists(place)) << "killed too early";
    return !fs::exists(in(model));
  }
};

TEST_F(ModelRecipe, MakesAModelWithContextAndJudge) {
  const Outcome run = make(recipe(), "m.forest");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* line :
       {"frames train +80 of 80 in ", "trees +4 in ", "context +samples of one, two in ", "judge +samples",
        "time +about ", "disk +0.00 GiB", "judge: [1-9][0-9]* samples of people, [1-9]"}) {
    EXPECT_THAT(run.err, ContainsRegex(line));
  }
  const Model model = load_model(in("m.forest"));
  EXPECT_EQ(model.forest.trees.size(), 3U);
  EXPECT_EQ(model.context.trees.size(), 120U);
  EXPECT_EQ(model.judge.trees.size(), 1600U);
  EXPECT_GT(model.forest.logit_unit, 0.F) << "leaves learned together";
  EXPECT_THAT(model.context.made_from, HasSubstr("# context of bodies, fitted to the first of every 2 frames, "));
  EXPECT_THAT(model.judge.made_from, HasSubstr("# data 2: 20 frames, seed 7, hash "));
  EXPECT_THAT(model.judge.made_from, Not(HasSubstr(testing::TempDir()))) << "folders are the user's own";
  EXPECT_EQ(run_program("detect " + frames() + " -m " + in("m.forest")).exit_code, 0);
  EXPECT_THAT(make(recipe(), "m.forest").err, HasSubstr("made by this recipe already"));
}

// Labels: threads
TEST_F(ModelRecipe, MakesTheSameBytesKilledOrNotForAnyNumberOfThreads) {
  const std::string file = recipe(), whole = made(file, "whole.forest", " --threads 3");
  ASSERT_FALSE(whole.empty());
  int killed = 0;
  for (const char* step : {"frames/train/dataset.json", "grown.forest", "samples/context-one", "samples/judge-one"}) {
    killed += make_until(file, "killed.forest", step) ? 1 : 0;
  }
  EXPECT_GE(killed, 2);
  EXPECT_EQ(made(file, "killed.forest", " --threads 1"), whole);
  write_file_atomically(in("killed.forest.work/samples/judge-two"), "damaged");
  write_file_atomically(in("killed.forest.work/grown.forest"), "damaged");
  fs::remove(in("killed.forest"));
  EXPECT_EQ(made(file, "killed.forest"), whole) << "what is damaged is made again";
}

TEST_F(ModelRecipe, MakesAgainOnlyWhatDependsOnAChange) {
  made(recipe(), "m.forest");
  const auto time_of = [](const std::string& name) { return fs::last_write_time(in("m.forest.work/" + name)); };
  const auto grown = time_of("grown.forest"), one = time_of("samples/judge-one"), two = time_of("samples/judge-two"),
             train = time_of("frames/train/000000.shard");
  const std::string judge = recipe(with(kRecipe, "people.none = 0.5", "people.none = 0.6"));
  const std::string changed = made(judge, "m.forest");
  EXPECT_EQ(time_of("grown.forest"), grown);
  EXPECT_EQ(time_of("frames/train/000000.shard"), train);
  EXPECT_GT(time_of("samples/judge-two"), two);
  EXPECT_GT(time_of("samples/judge-one"), one) << "another context judges";
  EXPECT_EQ(changed, made(judge, "fresh.forest"));
  const std::string leaves = recipe(with(kRecipe, "leaf-rounds = 3", "leaf-rounds = 2"));
  EXPECT_EQ(made(leaves, "m.forest"), made(leaves, "new.forest"));
  EXPECT_GT(time_of("grown.forest"), grown);
  EXPECT_EQ(time_of("frames/train/000000.shard"), train);
}

TEST_F(ModelRecipe, FitsAJudgeToTheForestOfAModelAtHand) {
  const std::string all = made(recipe(), "all.forest");
  Model other = load_model(in("all.forest"));
  other.judge = {3, 0.F, std::vector<BoostedTree>(1)};  // of another version
  save_model(other, in("other.forest"));
  std::string text = with(
      kRecipe,
      "frames = \"train\"\ntrees = 3\nhard-trees = 1\ndepth = 12\ncandidates = 20\npixels = 200\nleaf-rounds = 3\n",
      "model = \"other.forest\"\n");
  text = with(text, "[frames.train]\ncount = 80\nseed = 5\n", "");
  EXPECT_EQ(made(recipe(text), "again.forest"), all) << "the model says what it was made from, whatever it had before";
}

TEST_F(ModelRecipe, TakesADatasetAtHandAndBackgrounds) {
  made(recipe(), "m.forest");
  const std::string text = with(with(kRecipe, "count = 80\nseed = 5", "data = \"m.forest.work/frames/train\""),
                                "trees = 3", "background = \"" + frames() + "\"\ntrees = 3");
  const Outcome run = make(recipe(text), "data.forest");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(load_model(in("data.forest")).forest.recipe, HasSubstr("# background 1: 3 frames, sha256 "));
  EXPECT_FALSE(fs::exists(in("data.forest.work/frames/train")));
}

TEST_F(ModelRecipe, EstimatesAndScalesWithoutMaking) {
  const Outcome run = make(recipe(), "m.forest", " --estimate --scale 0.5");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, ContainsRegex("frames train +40 of 40 in "));
  EXPECT_THAT(run.out, ContainsRegex("\ntime +about .*\nmemory +at most .*\ndisk "));
  EXPECT_FALSE(fs::exists(in("m.forest")));
  EXPECT_FALSE(fs::exists(in("m.forest.work")));
  const std::string text = with(kRecipe, "[judge]\nframes = \"one, two\"", "[judge]\nframes = \"two\"");
  const Outcome trial = make(recipe(text), "t.forest", " --scale 0.01");
  EXPECT_EQ(trial.exit_code, 0) << trial.err;
  EXPECT_THAT(trial.err, HasSubstr("this trial goes on without")) << "two frames are too few for a judge";
}

TEST_F(ModelRecipe, RefusesWhatCannotWork) {
  const auto refused = [](const Outcome& run, int exit_code, const std::string& reason) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(in("m.forest")));
  };
  refused(make(recipe(with(kRecipe, "trees = 3", "tree = 3")), "m.forest"), 1,
          "r.toml:10: no option is called \"forest.tree\"");
  refused(make(recipe(), "m.forest", " --memory 0.01"), 1, "--memory allows 0.01");
  refused(make(recipe(), "m.forest", " --data " + frames()), 2, "the recipe of a model says");
  refused(run_program("train --scale 0.5 --count 3 --recipe " + recipe() + " --out " + in("m.forest")), 2, "--scale");
  std::string nobody = "[synth]\npeople.none = 1.0\n";
  for (const char* some : {"one", "two", "three", "four"}) nobody += std::string("people.") + some + " = 0.0\n";
  refused(make(recipe(with(kRecipe, "[synth]\n", nobody)), "m.forest"), 1, "no person in any of 80 frames");
}

}  // namespace
}  // namespace vesalius
