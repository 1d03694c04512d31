#include "commands/train/model_recipe.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>

#include "io/files/atomic_file.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

constexpr const char* kRecipe = R"([synth]
recipe = "base.toml"
people.two = 0.5
[forest]
frames = "plain, dressed"
trees = 3
[judge]
frames = "dressed"
step = 2
[frames.plain]
count = 4000
seed = 7
[frames.dressed]
looks = "low, crowd"
count = 10
people.three = 0.9
[look.low]
mounting = "wheelchair"
people.two = 0.6
[look.crowd]
people.two = 0.7
people.three = 0.7
)";

class ModelRecipes : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write_file_atomically(path("base.toml"), "people.two = 0.4\npeople.one = 0.3\n");
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ModelRecipe read(const std::string& toml) const {
    write_file_atomically(path("model.toml"), toml);
    return read_model_recipe(path("model.toml"));
  }
  std::string refusal(const std::string& toml) const {
    try {
      read(toml);
    } catch (const Error& e) {
      return e.what();
    }
    return "nothing";
  }
  static std::string with(std::string text, const std::string& old, const std::string& now) {
    return text.replace(text.find(old), old.size(), now);
  }

 private:
  const fs::path folder_ = fs::temp_directory_path() / ("vesalius_model_recipe_" + std::to_string(::getpid()));
};

TEST_F(ModelRecipes, PutsFileSynthLooksAndOwnOptionsOnTopOfEachOther) {
  const ModelRecipe recipe = read(kRecipe);
  const synth::Recipe &plain = recipe.set("plain").synth, &dressed = recipe.set("dressed").synth;
  EXPECT_FLOAT_EQ(plain.people.one, 0.3F);
  EXPECT_FLOAT_EQ(plain.people.two, 0.5F);
  EXPECT_FLOAT_EQ(plain.people.three, synth::Recipe().people.three);
  EXPECT_FLOAT_EQ(dressed.people.one, 0.3F);
  EXPECT_FLOAT_EQ(dressed.people.two, 0.7F);
  EXPECT_FLOAT_EQ(dressed.people.three, 0.9F);
  EXPECT_EQ(dressed.mounting, "wheelchair");
  EXPECT_FLOAT_EQ(dressed.camera.height_max_m, synth::camera_placement("wheelchair").height_max_m);
  EXPECT_FLOAT_EQ(plain.camera.height_max_m, synth::camera_placement("room").height_max_m);
}

TEST_F(ModelRecipes, SaysWhatEachStepLearnsFrom) {
  ModelRecipe recipe = read(kRecipe);
  EXPECT_THAT(recipe.forest_frames, ElementsAre("plain", "dressed"));
  EXPECT_EQ(recipe.forest.trees, 3);
  EXPECT_TRUE(recipe.context.frames.empty());
  EXPECT_THAT(recipe.judge.frames, ElementsAre("dressed"));
  EXPECT_EQ(recipe.judge.step, 2);
  EXPECT_EQ(recipe.set("plain").seed, 7);
  scale(recipe, 0.01);
  EXPECT_EQ(recipe.set("plain").count, 40);
  EXPECT_EQ(recipe.set("dressed").count, 2) << "few, but not none";
}

TEST_F(ModelRecipes, TakesPathsFromItsOwnFolder) {
  const ModelRecipe recipe =
      read("body = 'mine.toml'\n[forest]\nframes = 'at_hand'\nbackground = 'a, /b'\n[frames.at_hand]\ndata = '../d'\n");
  EXPECT_EQ(recipe.body, path("mine.toml"));
  EXPECT_THAT(recipe.backgrounds, ElementsAre(path("a"), "/b"));
  EXPECT_THAT(recipe.set("at_hand").data, EndsWith("/d"));
  EXPECT_EQ(recipe.set("at_hand").count, 0);
}

TEST_F(ModelRecipes, NamesThePlaceOfWhatItDoesNotKnow) {
  EXPECT_THAT(refusal(with(kRecipe, "people.two = 0.6", "people.too = 0.6")),
              HasSubstr("model.toml:19: no option is called \"look.low.people.too\"; did you mean "));
  EXPECT_THAT(refusal(with(kRecipe, "step = 2", "stop = 2")), HasSubstr("model.toml:9: no option is called"));
  EXPECT_THAT(refusal(with(kRecipe, "\"dressed\"", "\"dresed\"")),
              HasSubstr("model.toml:8: no set is called \"dresed\"; did you mean \"dressed\"?"));
  EXPECT_THAT(refusal(with(kRecipe, "low, crowd", "low, crow")), HasSubstr("no look is called \"crow\""));
  EXPECT_THAT(refusal(with(kRecipe, "plain, dressed", "dressed")), HasSubstr("model.toml:10: no step learns from set"));
  EXPECT_THAT(refusal(with(kRecipe, "count = 4000", "data = ''")), HasSubstr("set plain: expected count"));
  EXPECT_THAT(refusal(with(kRecipe, "people.three = 0.9", "people.three = -1.0")), HasSubstr("model.toml:16: "));
  EXPECT_THAT(refusal(with(kRecipe, "trees = 3", "model = 'a.forest'")), HasSubstr("expected one of forest.frames"));
  EXPECT_THAT(refusal("people.two = 0.5\n"), HasSubstr("expected the recipe of a model"));
}

constexpr const char* kNetworkRecipe = R"(labeller = "network"
[network]
frames = "plain, at_hand"
held-out = "seen"
config = "small"
views = 1000
init = "weights/f.npz"
python = "env/bin/python"
[frames.plain]
count = 4000
[frames.seen]
count = 20
[frames.at_hand]
data = "d"
)";

TEST_F(ModelRecipes, SayHowANetworkIsLearned) {
  ModelRecipe recipe = read(kNetworkRecipe);
  EXPECT_TRUE(recipe.network);
  EXPECT_THAT(recipe.learn.frames, ElementsAre("plain", "at_hand"));
  EXPECT_THAT(recipe.learn.held_out, ElementsAre("seen"));
  EXPECT_EQ(recipe.learn.config, "small");
  EXPECT_EQ(recipe.learn.init, path("weights/f.npz"));
  EXPECT_EQ(recipe.learn.python, path("env/bin/python"));
  scale(recipe, 0.1);
  EXPECT_EQ(recipe.learn.views, 100);
  EXPECT_FALSE(read(kRecipe).network);
  EXPECT_EQ(read(with(kNetworkRecipe, "env/bin/", "")).learn.python, "python") << "found as programs are";
}

TEST_F(ModelRecipes, NameThePlaceOfWhatANetworkDoesNotTake) {
  EXPECT_THAT(refusal(with(kNetworkRecipe, "\"network\"", "\"netwerk\"")),
              HasSubstr("model.toml:1: no labeller is called \"netwerk\"; did you mean \"network\"?"));
  EXPECT_THAT(refusal(with(kNetworkRecipe, "labeller = \"network\"", "")),
              HasSubstr("expected labeller = \"network\""));
  EXPECT_THAT(refusal(with(kNetworkRecipe, "\"small\"", "\"smal\"")),
              HasSubstr("model.toml:5: no config is called \"smal\"; did you mean \"small\"?"));
  EXPECT_THAT(refusal(with(kNetworkRecipe, "views", "vews")), HasSubstr("model.toml:6: no option is called"));
  EXPECT_THAT(refusal(with(kNetworkRecipe, "1000", "0")), HasSubstr("model.toml:6: "));
  EXPECT_THAT(refusal(with(kNetworkRecipe, "\"seen\"", "\"sen\"")), HasSubstr("model.toml:4: no set is called"));
  EXPECT_THAT(refusal(with(kNetworkRecipe, "data = \"d\"", "data = \"d\"\ncount = 3")),
              HasSubstr("set at_hand: a network learns from all of its data"));
  EXPECT_THAT(refusal(std::string(kNetworkRecipe) + "[forest]\nframes = 'seen'\n"),
              HasSubstr("model.toml:15: expected no [forest] beside [network]"));
  EXPECT_THAT(read(std::string(kNetworkRecipe) + "[judge]\nframes = 'seen'\n").judge.frames, ElementsAre("seen"));
  EXPECT_THAT(refusal("labeller = 'network'\n[frames.a]\ncount = 2\n"), HasSubstr("expected network.frames"));
}

/// Those of data/models, whole.
TEST_F(ModelRecipes, ReadsTheShippedOnes) {
  const auto frames_of = [](const ModelRecipe& recipe, const std::vector<std::string>& names) {
    return std::accumulate(names.begin(), names.end(), 0,
                           [&](int sum, const std::string& name) { return sum + recipe.set(name).count; });
  };
  const std::string folder = VESALIUS_SOURCE_DIR "/data/models/";
  const ModelRecipe whole = read_model_recipe(folder + "default.toml");
  EXPECT_EQ(frames_of(whole, whole.forest_frames), 100'000);
  EXPECT_EQ(frames_of(whole, whole.judge.frames), 27'500);
  EXPECT_EQ(whole.context.frames, whole.judge.frames);
  EXPECT_EQ(whole.forest.grow.leaf.max_depth, 20);
  EXPECT_FALSE(whole.set("clean_upright").synth.sensor.noise);
  EXPECT_FLOAT_EQ(whole.set("clean_upright").synth.camera.rolled_share, 0.F);
  EXPECT_EQ(whole.set("judge_home_blurred").synth.sensor.preset, "d435");
  EXPECT_FLOAT_EQ(whole.set("judge_home_blurred").synth.people.cut_out, 0.F);
  EXPECT_FLOAT_EQ(whole.set("kinect").synth.people.cut_out, 0.15F);
  const ModelRecipe small = read_model_recipe(folder + "small.toml");
  EXPECT_EQ(frames_of(small, small.forest_frames), 12'000);
  EXPECT_EQ(frames_of(small, small.judge.frames), 12'500);
  EXPECT_FALSE(read_model_recipe(folder + "quick.toml").judge.frames.empty());
  const ModelRecipe network = read_model_recipe(folder + "network.toml");
  EXPECT_TRUE(network.network);
  EXPECT_EQ(frames_of(network, network.learn.frames), 200'100);
  EXPECT_EQ(network.set("near").synth.body.count, 200);
  EXPECT_EQ(network.set("hall_d435").synth.body.count, 150);
  const ModelRecipe tune = read_model_recipe(folder + "tune.toml");
  EXPECT_EQ(tune.learn.init, folder + "default.model");
  EXPECT_FALSE(tune.judge.frames.empty());
}

}  // namespace
}  // namespace vesalius::cli
