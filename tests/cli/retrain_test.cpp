#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.h"
#include "small_frames.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

/// Runs the commands of docs/retrain.md in a folder of its own, on few and small frames.
class Retrain : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("vesalius_retrain_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    fs::copy(fs::path(VESALIUS_SOURCE_DIR) / "data/bodies/upper_body.toml", folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Returns the lines in the tutorial's blocks that begin with "vesalius", without that word. Writes its recipe for
  /// small frames.
  std::vector<std::string> commands() const {
    std::ifstream file(fs::path(VESALIUS_SOURCE_DIR) / "docs/retrain.md");
    std::vector<std::string> commands;
    std::ofstream recipe(folder_ / "ceiling.toml");
    std::string block;
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with("```")) {
        block = block.empty() ? line : "";
      } else if (block == "```toml") {
        recipe << line << '\n'
               << (line.starts_with("[synth]") ? as_toml(kSmallFrames) : "")
               << (line.starts_with("[frames.learn]") ? as_toml(kEasyFrames) : "");
      } else if (!block.empty() && line.starts_with("vesalius ")) {
        commands.push_back(line.substr(9));
      }
    }
    return commands;
  }

  /// Returns the command for small frames with its files in the test's folder. Nothing is fetched.
  std::string small(std::string command) const {
    for (const char* name : {"ceiling/", "empty/", "unseen/", "upper/", "people/", "found/", "report/", "look.png",
                             "parts.png", "children.png", "people.jsonl", "hands.jsonl", "ceiling.forest",
                             "ceiling.toml", "trial.forest", "upper.forest", "upper_body.toml"}) {
      replace_word(command, name, path(name));
    }
    replace_word(command, "20000", "150");
    replace_word(command, "100", "3");
    replace_word(command, "24", "3");
    if (command.starts_with("synth ")) command += std::string(" -q") + kSmallFrames + kEasyFrames;
    replace_word(command, "0.01", "0.005");
    if (command.starts_with("train ")) command += " --trees 3 --hard-trees 1 --depth 10 --held-out-share 0.1";
    if (command.starts_with("train --recipe") && command.find("--scale") == std::string::npos)
      command += " --scale 0.012";
    return command;
  }

 private:
  /// Returns flags as lines of TOML.
  static std::string as_toml(const std::string& flags) {
    std::istringstream words(flags);
    std::string toml, value;
    for (std::string flag; words >> flag >> value;) {
      const bool number = value.find_first_not_of("0123456789.") == std::string::npos;
      toml += flag.substr(2) + " = " + (number ? value : '"' + value + '"') + "\n";
    }
    return toml;
  }
  static void replace_word(std::string& text, const std::string& word, const std::string& by) {
    std::istringstream words(text);
    std::string replaced;
    for (std::string each; words >> each;) replaced += (replaced.empty() ? "" : " ") + (each == word ? by : each);
    text = replaced;
  }

  fs::path folder_;
};

TEST_F(Retrain, RunsTheTutorialsCommands) {
  ASSERT_EQ(
      run_program("synth -q --count 5 --seed 9 --format folder --out " + path("empty/") + kSmallFrames + kEmptyFrames)
          .exit_code,
      0);
  int trained = 0;
  for (const std::string& command : commands()) {
    if (command.starts_with("assets ")) continue;
    SCOPED_TRACE(command);
    const Outcome run = run_program(small(command));
    ASSERT_EQ(run.exit_code, 0) << run.err;
    if (!command.starts_with("train ") || command.find("--estimate") != std::string::npos) continue;
    EXPECT_GT(accuracy_in(run.err), 0.25) << "chance is at most 0.06: " << run.err;
    ++trained;
  }
  EXPECT_EQ(trained, 3);
  const Model ceiling = load_model(path("ceiling.forest"));
  EXPECT_EQ(ceiling.body.name, "paper25");
  EXPECT_FALSE(ceiling.context.empty() || ceiling.judge.empty());
  EXPECT_EQ(load_model(path("upper.forest")).body.name, "upper_body");
  for (const char* made : {"look.png", "parts.png", "report/report.html", "people.jsonl", "hands.jsonl"}) {
    EXPECT_FALSE(bytes_of(path(made)).empty()) << made;
  }
}

}  // namespace
}  // namespace vesalius
