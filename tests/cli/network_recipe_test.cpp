#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "io/model/model_contents.h"
#include "run_program.h"
#include "vesalius/model_file.h"
#include "vesalius/network/test_networks.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::MatchesRegex;

/// `vesalius train` by the recipe of a network, with a Python that is none.
class NetworkRecipe : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write_file_atomically(path("net.toml"), R"(labeller = "network"
[synth]
sensor.width = 96
sensor.height = 72
sensor.colour = false
body.kind = "builtin"
body.count = 2
pose.captured = 0.0
[network]
frames = "learn"
held-out = "unseen"
config = "small"
views = 40
python = "./python"
[frames.learn]
count = 4
[frames.unseen]
count = 2
seed = 2
)");
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static Network random_network(int parts) {
    Random random(1, 0);
    return test::random_network(random, test::kSmallShape, parts);
  }

  /// Writes what the tool leaves.
  void write_learned(const std::string& name, const Network& network) const {
    ByteWriter file;
    file.text("how it was made");
    write_network(file, network);
    write_file_atomically(path(name), file.bytes());
  }

  /// Trains with a Python that does this when it is to learn, after it has put its arguments into `arguments`.
  Outcome train(const std::string& learning, const std::string& importing = "exit 0") const {
    write_file_atomically(path("python"), "#!/bin/sh\n[ \"$1\" = -c ] && { " + importing + "; }\necho \"$*\" > " +
                                              path("arguments") + "\n" + learning + "\n");
    fs::permissions(path("python"), fs::perms::owner_all);
    return run_program("train --recipe " + path("net.toml") + " --threads 1 --out " + path("out"));
  }

 private:
  const fs::path folder_ = fs::temp_directory_path() / ("vesalius_network_recipe_" + std::to_string(::getpid()));
};

TEST_F(NetworkRecipe, HasFramesRenderedAndANetworkLearned) {
  const Network network = random_network(25);
  write_learned("learned", network);
  const Outcome run =
      train("echo 'views 40 of 40'\ncp " + path("learned") + " " + path("out.work/network/network.network"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Model model = load_model(path("out"));
  ASSERT_NE(model.network, nullptr);
  EXPECT_EQ(model.network->layers.size(), network.layers.size());
  EXPECT_EQ(model.body.name, "paper25");
  EXPECT_THAT(run.err, HasSubstr("views 40 of 40"));
  EXPECT_THAT(bytes_of(path("arguments")),
              MatchesRegex("-m vesalius_network .*/frames/learn --held-out .*/frames/unseen --out .*/network "
                           "--config small --views 40 --seed 1 --device cpu --threads 1 --memory [0-9.]+\n"));
  for (const char* set : {"learn", "unseen"}) {
    EXPECT_TRUE(fs::exists(path("out.work/frames/") + set + "/000000.shard")) << set;
  }
}

TEST_F(NetworkRecipe, IsNotNeededToConvertANetworkOfAnotherBody) {
  const std::string body = VESALIUS_SOURCE_DIR "/data/bodies/upper_body.toml";
  const int parts = parse_body_model(bytes_of(body), body).part_count();
  write_learned("upper.network", random_network(parts));
  const std::string convert = "convert -q " + path("upper.network") + " " + path("upper.model");
  const Outcome run = run_program(convert + " --body " + body);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(load_model(path("upper.model")).body.part_count(), parts);
  fs::remove(path("upper.model"));
  const Outcome without = run_program(convert);
  EXPECT_EQ(without.exit_code, 1);
  EXPECT_THAT(without.err, HasSubstr(path("upper.network") + ": network: classes are a wide picture of"));
  EXPECT_FALSE(fs::exists(path("upper.model")));
}

TEST_F(NetworkRecipe, NamesTheFileOfANetworkThatIsInconsistent) {
  Network network = random_network(25);
  network.layers[0].scale[0] = 0.F;
  write_learned("spoilt.network", network);
  const Outcome run = run_program("convert " + path("spoilt.network") + " " + path("spoilt.model"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr(path("spoilt.network") + ": network: layer 0: a scale"));
  EXPECT_FALSE(fs::exists(path("spoilt.model")));
}

TEST_F(NetworkRecipe, SaysWhatTheToolSays) {
  const Outcome run = train("echo 'vesalius_network: losses are not finite' >&2; exit 1");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("vesalius_network: losses are not finite"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(NetworkRecipe, WantsAPythonWithPyTorchBeforeItRenders) {
  const Outcome run = train("", "echo \"ModuleNotFoundError: No module named 'torch'\" >&2; exit 1");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("No module named 'torch'; expected in network.python a Python"));
  EXPECT_FALSE(fs::exists(path("out.work/frames")));
}

TEST_F(NetworkRecipe, RefusesABeginningBeforeItRenders) {
  const std::string models = VESALIUS_SOURCE_DIR "/data/models/", recipe = bytes_of(path("net.toml"));
  const auto refused = [&](const std::string& init, const std::string& message) {
    std::string begun = recipe;
    begun.insert(begun.find("python ="), "init = \"" + init + "\"\n");
    write_file_atomically(path("net.toml"), begun);
    const Outcome run = train("exit 1");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_FALSE(fs::exists(path("out.work/frames")));
  };
  refused("none.model", path("none.model") + ": cannot be read");
  refused(models + "capsule.forest", "capsule.forest: expected a model whose labeller is a network");
  std::string damaged = bytes_of(models + "default.model");
  damaged[damaged.size() / 2] ^= 1;
  write_file_atomically(path("damaged.model"), damaged);
  refused("damaged.model", path("damaged.model"));
}

TEST_F(NetworkRecipe, IsEstimatedWithoutPython) {
  const Outcome run = run_program("train --estimate --recipe " + path("net.toml"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("frames learn"));
  EXPECT_EQ(run_program("train --recipe " + path("net.toml") + " --out x --report " + path("r")).exit_code, 2);
}

}  // namespace
}  // namespace vesalius
