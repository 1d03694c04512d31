#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "io/model/model_sections.h"
#include "io/model/text_trees.h"
#include "run_program.h"
#include "small_world.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Commands : public SmallWorld {};

TEST_F(Commands, PrintHelpAndVersion) {
  const Outcome help = run_program("--help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("vesalius detect frames/"));
  const Outcome version = run_program("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, testing::MatchesRegex("vesalius [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  const Outcome nothing = run_program("");
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_EQ(nothing.out, "");
  EXPECT_EQ(nothing.err, help.out);
}

TEST_F(Commands, AllHaveHelp) {
  for (const char* command :
       {"detect", "record", "cameras", "view", "bench", "info", "convert", "export", "assets", "options"}) {
    const Outcome run = run_program(std::string(command) + " --help");
    EXPECT_EQ(run.exit_code, 0) << command;
    EXPECT_THAT(run.out, HasSubstr(std::string("Usage: vesalius ") + command));
  }
}

TEST_F(Commands, HelpNamesCardsOnlyWhereThereAreKernels) {
  const json parts = json::parse(run_program("info --json").out).at("parts_of_this_build");
  const bool kernels = parts.at("cuda").at("kernels") == "present";
  const std::string help = run_program("detect --help").out;
  EXPECT_EQ(help.find("cuda:N (a card)") != help.npos, kernels);
  EXPECT_EQ(help.find("this build has no kernels for cards") != help.npos, !kernels);
}

TEST_F(Commands, InfoDescribesTheBuild) {
  const Outcome run = run_program("info --json");
  ASSERT_EQ(run.exit_code, 0);
  const json facts = json::parse(run.out);
  EXPECT_EQ(facts.at("model_format"), kModelVersion);
  EXPECT_GE(facts.at("threads"), 1);
  EXPECT_THAT(facts.at("parts_of_this_build").at("cuda").at("kernels"), AnyOf(json("absent"), json("present")));
  EXPECT_THAT(run_program("info").out, HasSubstr("compiler: "));
}

TEST_F(Commands, BenchMeasuresStages) {
  const Outcome run = run_program("bench " + frames() + " -q -m " + model() + " --frames 4 --threads both --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json figures = json::parse(run.out);
  EXPECT_EQ(figures.at("frames"), 4) << "the three over again";
  EXPECT_EQ(figures.at("size_px"), (json{320, 240}));
  EXPECT_GT(figures.at("peak_memory_mb"), 1.0);
  EXPECT_EQ(figures.at("runs").at(0).at("threads"), 1);
  for (const json& one : figures.at("runs")) {
    EXPECT_GT(one.at("frames_per_s"), 0.0);
    const json& detect = one.at("stages").at("detect");
    EXPECT_LE(detect.at("median_ms"), detect.at("p99_ms"));
    EXPECT_GE(detect.at("median_ms"), one.at("stages").at("label").at("median_ms"));
  }
  EXPECT_THAT(run_program("bench " + frames() + " -m " + model() + " --threads 1").out, HasSubstr("\n1 thread: "));
  EXPECT_THAT(run_program("bench " + frames() + " -m " + model() + " --threads 1 --track --frames 5").out,
              HasSubstr("\ntrack "));
  EXPECT_EQ(run_program("bench " + frames() + " -m " + model() + " --threads many").exit_code, 2);
}

TEST_F(Commands, InfoDescribesAModel) {
  const Outcome run = run_program("info --json " + model());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json facts = json::parse(run.out);
  const std::string bytes = bytes_of(model());
  const Model described = parse_model(bytes, "m");
  const Forest& forest = described.forest;
  EXPECT_EQ(facts.at("size_bytes"), bytes.size());
  EXPECT_EQ(facts.at("checksum"), model_checksum(bytes));
  EXPECT_EQ(facts.at("recipe"), forest.recipe);
  std::vector<std::string> sections;
  for (const json& section : facts.at("sections")) sections.push_back(section.at("name"));
  EXPECT_THAT(sections, testing::ElementsAre("body", "forest"));
  EXPECT_EQ(facts.at("background_class"), forest.has_background);
  EXPECT_EQ(facts.at("headings"), forest.headings);
  EXPECT_EQ(facts.at("judge_trees"), described.judge.trees.size());
  EXPECT_EQ(facts.at("body").at("parts").size(), 25U);
  ASSERT_EQ(facts.at("trees").size(), forest.trees.size());
  EXPECT_EQ(facts.at("trees").at(1).at("nodes"), forest.trees[1].nodes.size());
  std::size_t nodes = 0, leaves = 0;
  for (const Tree& tree : forest.trees) nodes += tree.nodes.size(), leaves += tree.leaves.size();
  EXPECT_EQ(facts.at("nodes"), nodes);
  EXPECT_EQ(facts.at("leaves"), leaves);
  EXPECT_NEAR(facts.at("bytes_per_node"), static_cast<double>(bytes.size()) / static_cast<double>(nodes), 0.0051);
  EXPECT_EQ(facts.at("trees").at(1).at("depth"), depth(forest.trees[1]));
  EXPECT_THAT(run_program("info " + model()).out, HasSubstr("  depth "));
}

TEST_F(Commands, InfoKeepsAModelsTextFromTheTerminal) {
  Model rude = load_model(model());
  rude.forest.recipe =
      "honest\n\x1b[2Jgone \xc2\x9b"
      "31m";
  save_model(rude, path("rude.forest"));
  const Outcome text = run_program("info " + path("rude.forest"));
  EXPECT_THAT(text.out, HasSubstr("honest\n\\x1b[2Jgone \\xc2\\x9b31m"));
  const Outcome as_json = run_program("info --json " + path("rude.forest"));
  EXPECT_EQ(json::parse(as_json.out).at("recipe"), rude.forest.recipe);
  for (const std::string& out : {text.out, as_json.out}) {
    EXPECT_EQ(out.find('\x1b'), std::string::npos);
    EXPECT_EQ(out.find("\xc2\x9b"), std::string::npos);
  }
}

TEST_F(Commands, OptionsPrintsAnOptionsFile) {
  const Outcome run = run_program("options");
  ASSERT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("\nsearch.min-parts = 4\n"));
  write("printed.toml", run.out);
  const std::string detect = "detect " + frames() + " -q --json - -m " + model();
  const Outcome with = run_program(detect + " --options " + path("printed.toml"));
  EXPECT_EQ(with.exit_code, 0) << with.err;
  EXPECT_EQ(with.out, run_program(detect).out) << "the defaults, once more";
}

TEST_F(Commands, ConvertTurnsTextTreesIntoAModel) {
  write("one.txt", "1\n10 0 0 0 5\n3\n4\n");
  write("two.txt", "0\n24\n");
  const Outcome run = run_program("convert -q " + path("one.txt") + " " + path("two.txt") + " " + path("text.forest"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Forest forest = load_model(path("text.forest")).forest;
  EXPECT_EQ(forest.trees, import_text_trees({path("one.txt"), path("two.txt")}).trees);
  const Outcome bad = run_program("convert " + frames() + "/meta.json " + path("bad.forest"));
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.err, StartsWith("vesalius: "));
  EXPECT_FALSE(std::filesystem::exists(path("bad.forest")));
}

TEST_F(Commands, ConvertPutsAnotherBodyIntoAModel) {
  std::string text = paper_body().toml;
  text.replace(text.find("length = "), 9, "length = 1");
  write("longer.toml", text);
  const Outcome run =
      run_program("convert -q " + model() + " " + path("longer.forest") + " --body " + path("longer.toml"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Forest forest = load_model(path("longer.forest")).forest;
  EXPECT_EQ(forest.body.toml, text);
  EXPECT_EQ(forest.trees, load_model(model()).forest.trees);
  const Outcome refused = run_program("convert " + model() + " " + model() + " " + path("same.forest"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("expected one other name"));
}

TEST_F(Commands, ConvertKeepsThePeopleInFrames) {
  const std::string flags = " --no-track -q --json - -m " + model();
  const auto people = [&](const std::string& source) {
    std::vector<json> found;
    std::istringstream in(run_program("detect " + source + flags).out);
    for (std::string line; std::getline(in, line);) {
      if (const json parsed = json::parse(line); parsed.contains("people")) found.push_back(parsed.at("people"));
    }
    return found;
  };
  const auto expected = people(frames());
  ASSERT_EQ(expected.size(), 3U);
  for (const std::string layout : {"folder", "tum"}) {
    const std::string folder = path("as_" + layout);
    const std::string rate = layout == "tum" ? " --rate 30" : "";  // these frames have no times
    const Outcome run = run_program("convert -q " + frames() + " " + folder + " --to " + layout + rate);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(people(folder), expected) << layout;
    const Outcome again = run_program("convert -q " + frames() + " " + folder + " --to " + layout + rate);
    EXPECT_EQ(again.exit_code, 1) << "a folder with files in it is left alone";
  }
}

TEST_F(Commands, ConvertRefusesTumWithoutTimes) {
  const Outcome refused = run_program("convert " + frames() + " " + path("timeless") + " --to tum");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("frame a has no time, which this layout needs"));
  EXPECT_THAT(refused.err, HasSubstr("--rate"));
  const Outcome run = run_program("convert " + frames() + " " + path("timed") + " --to tum --rate 10");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("names frames by their times"));
  EXPECT_THAT(bytes_of(path("timed/depth.txt")), HasSubstr("\n0.100000 depth/0.100000.png\n"));
}

/// Returns what bash would offer for the last of these words, each between spaces.
std::string bash_offers(const std::string& words) {
  const std::string script =
      "source " VESALIUS_SOURCE_DIR
      "/data/completion.bash; COMP_WORDS=(\"$0\" \"$@\"); COMP_CWORD=$#; _vesalius; echo \" ${COMPREPLY[*]} \"";
  const Outcome run = run_program(words, "bash -c '" + script + "'");
  return run.out + run.err;
}

TEST_F(Commands, CompletionOffersCommandsFlagsAndChoicesInBash) {
  EXPECT_EQ(bash_offers("de"), " detect \n");
  EXPECT_THAT(bash_offers("\"\""), AllOf(HasSubstr(" detect "), HasSubstr(" info "), HasSubstr(" --help ")));
  EXPECT_EQ(bash_offers("detect --js"), " --json \n");
  EXPECT_EQ(bash_offers("detect --search.min-p"), " --search.min-parts \n");
  EXPECT_EQ(bash_offers("detect --save o"), " overlay \n");
  EXPECT_THAT(bash_offers("info --"), AllOf(HasSubstr(" --json "), Not(HasSubstr("--save"))));
  EXPECT_THAT(bash_offers("options s"), HasSubstr(" synth "));
}

}  // namespace
}  // namespace vesalius
