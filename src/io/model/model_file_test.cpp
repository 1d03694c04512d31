#include "vesalius/model_file.h"

#include <gmock/gmock.h>

#include <functional>

#include "io/files/atomic_file.h"
#include "io/files/test_files.h"
#include "io/model/model_contents.h"
#include "io/model/model_sections.h"
#include "io/model/test_forest.h"
#include "vesalius/error.h"
#include "vesalius/network/test_networks.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using test::random_forest;
using test::tiny_forest;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

/// Changes a section and corrects sizes and checksums, as only a forger or a bug would.
std::string forged(const std::string& bytes, const std::string& section,
                   const std::function<std::string(std::string)>& change) {
  std::vector<ModelSection> sections = split_sections(bytes, "m");
  std::string changed;
  for (ModelSection& each : sections) {
    if (each.name != section) continue;
    changed = change(std::string(each.bytes));
    each.bytes = changed;
  }
  return join_sections(sections);
}

/// Parses what each change of one of every `step` bytes of a section makes of the file, and its truncation there.
/// Returns how many were accepted.
int parse_changed(const std::string& bytes, const std::string& section, std::size_t step = 1) {
  int accepted = 0;
  const auto parse = [&](const std::string& changed) {
    try {
      const Model model = parse_model(changed, "m");
      EXPECT_NO_THROW(check(model));
      ++accepted;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), StartsWith("m"));
    }
  };
  std::size_t size = 0;
  for (const ModelSection& each : split_sections(bytes, "m")) size = each.name == section ? each.bytes.size() : size;
  EXPECT_GT(size, 0U);
  for (std::size_t n = 0; n < size; n += step) {
    for (const char value : {'\0', '\x01', '\x7f', '\xff'}) {
      parse(forged(bytes, section, [&](std::string content) { return content.replace(n, 1, 1, value); }));
    }
    EXPECT_THROW(
        parse_model(forged(bytes, section, [&](const std::string& content) { return content.substr(0, n); }), "m"),
        Error)
        << n;
  }
  EXPECT_THROW(parse_model(forged(bytes, section, [](const std::string& content) { return content + '\0'; }), "m"),
               Error);
  return accepted;
}

TEST(ModelFile, KeepsEverythingInARoundTrip) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Forest forest = random_forest(seed);
    const Model model = parse_model(serialise_model(forest), "m");
    const Forest& again = model.forest;
    EXPECT_EQ(again.trees, forest.trees);
    EXPECT_EQ(again.convention, forest.convention);
    EXPECT_EQ(again.has_background, forest.has_background);
    EXPECT_EQ(again.recipe, forest.recipe);
    EXPECT_EQ(model.body.toml, forest.body.toml);
  }
}

TEST(ModelFile, KeepsTheJudge) {
  Model model = random_forest(4);
  Random random(5, 0);
  test::add_judge(model, 20, random);
  model.judge.made_from = "some people";
  const std::string bytes = serialise_model(model);
  EXPECT_EQ(parse_model(bytes, "m").judge, model.judge);
  EXPECT_TRUE(parse_model(serialise_model(random_forest(4)), "m").judge.empty());
  model.judge.features = 1;
  EXPECT_THAT([&] { serialise_model(model); }, ThrowsMessage<Error>(HasSubstr("judge of people asks for a feature")));
}

Model network_model() {
  Random random(11, 0);
  Model model;
  model.body = paper_body();
  Network network = test::random_network(random, {{4, 4, 4, 4, 4}, {0, 1, 0, 0, 0}, {4, 4, 4, 4}}, 25);
  network.made_from = "frames of people";
  model.network = std::make_shared<Network>(std::move(network));
  return model;
}

TEST(ModelFile, KeepsANetwork) {
  for (const bool centres : {true, false}) {
    Model model = network_model();
    if (!centres) model.network = std::make_shared<Network>(test::without_centres(*model.network));
    const std::string bytes = serialise_model(model);
    const Model again = parse_model(bytes, "m");
    ASSERT_NE(again.network, nullptr);
    EXPECT_EQ(again.network->layers, model.network->layers);
    EXPECT_EQ(again.network->classes_of, model.network->classes_of);
    EXPECT_EQ(again.network->person_of, model.network->person_of);
    EXPECT_EQ(again.network->centres_of, model.network->centres_of);
    EXPECT_EQ(labeller_recipe(again), "frames of people");
    EXPECT_EQ(serialise_model(again), bytes);
  }
}

/// Returns a file whose section of the network is of another version and lacks as many bytes.
std::string cut_network(const std::string& bytes, int version, std::size_t cut) {
  std::vector<ModelSection> sections = split_sections(bytes, "m");
  for (ModelSection& each : sections) {
    if (each.name != "network") continue;
    each.version = version;
    each.bytes.remove_suffix(cut);
  }
  return join_sections(sections);
}

TEST(ModelFile, ReadsANetworkFromBeforeThereWereCentres) {
  Model model = network_model();
  model.network = std::make_shared<Network>(test::without_centres(*model.network));
  const std::string bytes = serialise_model(model);
  const Model again = parse_model(cut_network(bytes, 1, 2), "m");
  EXPECT_EQ(again.network->layers, model.network->layers);
  EXPECT_EQ(again.network->centres_of, -1);
  EXPECT_EQ(serialise_model(again), bytes);
  const auto refused = [&](int version, std::size_t cut, const char* message) {
    EXPECT_THAT([&] { parse_model(cut_network(bytes, version, cut), "m"); }, ThrowsMessage<Error>(HasSubstr(message)));
  };
  refused(1, 0, "section \"network\"");
  refused(1, 3, "layer of votes");
  refused(2, 1, "layer of centres");
  refused(2, 2, "layer of centres");
  refused(3, 0, "m: section \"network\" is of version 3, this program reads 2");
  refused(0, 0, "m: section \"network\" is of version 0, this program reads 2");
}

TEST(ModelFile, LoadsWhatTrainingANetworkLeaves) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "a.network";
  const Model model = network_model();
  for (const bool centres : {true, false}) {
    const Network network = centres ? *model.network : test::without_centres(*model.network);
    ByteWriter file;
    file.text("how it was made");
    write_network(file, network);
    write_file_atomically(path, file.bytes());
    const Network again = load_network(path, 25);
    EXPECT_EQ(again.layers, network.layers);
    EXPECT_EQ(again.centres_of, network.centres_of);
    EXPECT_EQ(again.made_from, "how it was made");
    write_file_atomically(path, file.bytes().substr(0, file.bytes().size() - 1));
    EXPECT_THAT([&] { load_network(path, 25); }, ThrowsMessage<Error>(HasSubstr("layer of centres")));
  }
}

TEST(ModelFile, RefusesDamagedNetworks) { parse_changed(serialise_model(network_model()), "network", 23); }

TEST(ModelFile, NeedsSomethingThatLabels) {
  const std::string bytes = serialise_model(network_model());
  std::vector<ModelSection> sections = split_sections(bytes, "m");
  std::erase_if(sections, [](const ModelSection& section) { return section.name == "network"; });
  EXPECT_THAT([&] { parse_model(join_sections(sections), "m"); },
              ThrowsMessage<Error>(HasSubstr("neither a section \"forest\" nor \"network\"")));
}

TEST(ModelFile, KeepsTheContext) {
  Model model = random_forest(4);
  Random random(6, 0);
  test::add_judge(model, 20, random);
  model.context = model.judge;
  model.context.bias = -1.5F;
  const Model again = parse_model(serialise_model(model), "m");
  EXPECT_EQ(again.context, model.context);
  EXPECT_EQ(again.judge, model.judge);
  model.judge = {};
  EXPECT_EQ(parse_model(serialise_model(model), "m").context, model.context) << "without a judge";
}

TEST(ModelFile, KeepsTheNamesOfWhatContextAndJudgeAskFor) {
  Model model = random_forest(4);
  Random random(6, 0);
  test::add_judge(model, 3, random);
  model.context = model.judge;
  for (int f = 0; f < model.judge.features; ++f) model.judge.asks.push_back("kind " + std::to_string(f));
  const Model again = parse_model(serialise_model(model), "m");
  EXPECT_EQ(again.judge, model.judge);
  EXPECT_EQ(again.context, model.context) << "which has no names";
  model.judge.asks.pop_back();
  EXPECT_THAT([&] { serialise_model(model); }, ThrowsMessage<Error>(HasSubstr("29 names of 30 features")));
}

TEST(ModelFile, KeepsLogitsAndHeadings) {
  for (const int headings : {0, 8}) {
    Forest forest = random_forest(3);
    Random random(9, 0);
    test::add_logits(forest, headings, random);
    const std::string bytes = serialise_model(forest);
    const Model again = parse_model(bytes, "m");
    EXPECT_EQ(again.forest.trees, forest.trees);
    EXPECT_EQ(again.forest.logit_unit, forest.logit_unit);
    EXPECT_EQ(again.forest.headings, headings);
    EXPECT_EQ(again.headings.weights, forest.facing.weights);
    EXPECT_EQ(bytes, serialise_model(again));
  }
}

TEST(ModelFile, RefusesDamagedLogits) {
  Forest forest = tiny_forest();
  Random random(9, 0);
  test::add_logits(forest, 8, random);
  const std::string bytes = serialise_model(forest);
  parse_changed(bytes, "forest");
  parse_changed(bytes, "headings");
  forest.trees[0].logits.pop_back();
  EXPECT_THROW(serialise_model(forest), Error);
}

// Labels: threads
TEST(ModelFile, WritesTheSameBytesForTheSameForest) {
  const std::string bytes = serialise_model(random_forest(5));
  EXPECT_EQ(bytes, serialise_model(random_forest(5)));
  EXPECT_EQ(bytes, serialise_model(parse_model(bytes, "m")));
  EXPECT_EQ(model_checksum(bytes).size(), 16U);
  EXPECT_NE(model_checksum(bytes), model_checksum(serialise_model(random_forest(6))));
  const ThreadLimit one(1);
  EXPECT_EQ(bytes, serialise_model(random_forest(5)));
}

TEST(ModelFile, DoesNotWriteLabelsOfUnusedSlots) {
  Forest forest = random_forest(5);
  forest.trees.back().leaves[0] = {.label = {1, 0, 0, 9}, .probability = {255, 0, 0, 0}};
  const std::string bytes = serialise_model(forest);
  forest.trees.back().leaves[0].label[3] = 0;
  EXPECT_EQ(bytes, serialise_model(forest));
}

TEST(ModelFile, DoesNotWriteClassesOfLeavesWithLogits) {
  Forest forest = random_forest(5);
  Random random(5);
  test::add_logits(forest, 8, random);
  const std::string bytes = serialise_model(forest);
  for (Tree& tree : forest.trees) {
    for (TreeLeaf& leaf : tree.leaves) leaf = test::random_leaf(random, 25);
  }
  EXPECT_EQ(bytes, serialise_model(forest));
}

TEST(ModelFile, RefusesEveryTruncation) {
  const std::string bytes = serialise_model(tiny_forest());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_THROW(parse_model(std::string_view(bytes).substr(0, n), "m"), Error) << n;
  }
  EXPECT_THROW(parse_model(bytes + '\0', "m"), Error);
}

TEST(ModelFile, RefusesEveryChangedByte) {
  const std::string bytes = serialise_model(tiny_forest());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string changed = bytes;
      changed[n] = static_cast<char>(changed[n] ^ flip);
      EXPECT_THROW(parse_model(changed, "m"), Error) << n;
    }
  }
}

TEST(ModelFile, ChecksTheModelAfterTheChecksums) {
  Model model = tiny_forest();
  Random random(6, 0);
  test::add_judge(model, 1, random);
  const std::string bytes = serialise_model(model);
  EXPECT_GT(parse_changed(bytes, "forest"), 0) << "a changed threshold, for example, is a valid forest";
  parse_changed(bytes, "judge");
}

/// Returns what is said of a file that cannot be read.
std::string message(const std::string& bytes) {
  try {
    parse_model(bytes, "a.forest");
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}

TEST(ModelFile, SaysWhatIsWrong) {
  const std::string bytes = serialise_model(tiny_forest());
  EXPECT_EQ(message(""), "a.forest: empty file, expected a vesalius model");
  EXPECT_THAT(message("20\n 1 2 3 4 5\n"), StartsWith("a.forest: not a vesalius model"));
  EXPECT_EQ(message(bytes.substr(0, 11)), "a.forest: truncated model, 11 bytes of the 24 of its header");
  EXPECT_THAT(message(bytes.substr(0, 30)), HasSubstr("truncated model, 6 of "));
  std::string newer = bytes;
  newer[8] = 4;
  EXPECT_EQ(message(newer), "a.forest: written by a newer version: format 4, this program reads 3");
  std::string older = bytes;
  older[8] = 2;
  EXPECT_EQ(message(older), "a.forest: model of format 2; `vesalius convert OLD NEW` makes it format 3");
  std::string damaged = bytes;
  damaged[40] = static_cast<char>(damaged[40] ^ 1);
  EXPECT_EQ(message(damaged), "a.forest: damaged model, the checksum of its table of sections does not match");
}

TEST(ModelFile, NamesTheSectionThatIsWrong) {
  Model model = tiny_forest();
  Random random(6, 0);
  test::add_judge(model, 1, random);
  const std::string bytes = serialise_model(model);
  const auto with = [&](const std::function<void(std::vector<ModelSection>&)>& change) {
    std::vector<ModelSection> sections = split_sections(bytes, "m");
    change(sections);
    return message(join_sections(sections));
  };
  ASSERT_EQ(split_sections(bytes, "m").size(), 3U) << "body, forest, judge";
  EXPECT_THAT(message(bytes.substr(0, bytes.size() - 1)), HasSubstr("section \"judge\": truncated, "));
  std::string damaged = bytes;
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  EXPECT_EQ(message(damaged), "a.forest: section \"judge\": damaged, its checksum does not match");
  EXPECT_EQ(message(bytes + '\0'), "a.forest: damaged model, 1 bytes behind its last section");
  EXPECT_EQ(with([](auto& sections) { sections.push_back(sections[2]); }),
            "a.forest: section \"judge\": is there twice");
  EXPECT_EQ(with([&](auto& sections) { std::erase_if(sections, [&](const auto& s) { return s.name == "body"; }); }),
            "a.forest: no section \"body\", expected one in every model");
  EXPECT_EQ(with([](auto& sections) { sections[2].version = 2; }),
            "a.forest: section \"judge\" is of version 2, this program reads 1");
}

TEST(ModelFile, SkipsUnknownSectionsThatMayBeSkippedAlone) {
  const std::string bytes = serialise_model(tiny_forest());
  std::vector<ModelSection> sections = split_sections(bytes, "m");
  sections.push_back({"hat", 1, true, "felt", "brim"});
  EXPECT_EQ(serialise_model(parse_model(join_sections(sections), "m")), bytes);
  sections.back().skippable = false;
  EXPECT_EQ(message(join_sections(sections)),
            "a.forest: section \"hat\" is not known to this version, which cannot go without it");
}

TEST(ModelFile, IsReadWhateverTheOrderOfItsSections) {
  const std::string bytes = serialise_model(tiny_forest());
  std::vector<ModelSection> sections = split_sections(bytes, "m");
  std::ranges::reverse(sections);
  EXPECT_EQ(serialise_model(parse_model(join_sections(sections), "m")), bytes);
}

TEST(ModelFile, DoesNotWriteWhatALabellerReplaced) {
  EXPECT_THAT([] { serialise_model(on_device(tiny_forest())); }, ThrowsMessage<Error>(HasSubstr("labeller in place")));
}

TEST(ModelFile, DoesNotWriteAnInconsistentForest) {
  Forest forest = random_forest(1);
  forest.trees[0].nodes[3].left = 3;
  EXPECT_THROW(serialise_model(forest), Error);
  Forest other = random_forest(1);
  other.body.parts[4].name = "renamed";
  EXPECT_THROW(serialise_model(other), Error);
}

TEST(ModelFile, SavesAndLoads) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "m.forest";
  const Forest forest = random_forest(8);
  save_model(forest, path);
  EXPECT_EQ(load_model(path).forest.trees, forest.trees);
  EXPECT_EQ(folder.file_count(), 1U) << "nothing else is left in the folder";
  EXPECT_THAT([] { load_model("/nowhere/m.forest"); }, ThrowsMessage<Error>(HasSubstr("/nowhere/m.forest")));
  EXPECT_THAT([&] { save_model(forest, "/nowhere/m.forest"); }, ThrowsMessage<Error>(HasSubstr("/nowhere/m.forest")));
  EXPECT_THAT([&] { save_model(forest, "/dev/full"); }, ThrowsMessage<Error>(HasSubstr("/dev/full")));
}

}  // namespace
}  // namespace vesalius
