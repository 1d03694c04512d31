#include "io/model/model_file.h"

#define XXH_INLINE_ALL
#include <gmock/gmock.h>
#include <xxhash.h>

#include <cstdlib>
#include <cstring>
#include <fstream>

#include "io/files/test_files.h"
#include "io/model/test_forest.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"

namespace vesalius {
namespace {

using test::random_forest;
using test::tiny_forest;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

/// Overwrites bytes and corrects the checksum, as only a forger or a bug would.
std::string forged(std::string bytes, std::size_t at, std::string_view with) {
  bytes.replace(at, with.size(), with);
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 12, &size, 8);
  std::string hashed = bytes.substr(0, 20) + bytes.substr(28);
  const std::uint64_t sum = XXH64(hashed.data(), hashed.size(), 0);
  std::memcpy(bytes.data() + 20, &sum, 8);
  return bytes;
}

TEST(ModelFile, KeepsEverythingInARoundTrip) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Forest forest = random_forest(seed);
    const Forest again = parse_model(serialise_model(forest), "m");
    EXPECT_EQ(again.trees, forest.trees);
    EXPECT_EQ(again.convention, forest.convention);
    EXPECT_EQ(again.has_background, forest.has_background);
    EXPECT_EQ(again.recipe, forest.recipe);
    EXPECT_EQ(again.body.toml, forest.body.toml);
  }
}

TEST(ModelFile, KeepsTheJudge) {
  Forest forest = random_forest(4);
  Random random(5, 0);
  test::add_judge(forest, 20, random);
  const std::string bytes = serialise_model(forest);
  EXPECT_EQ(parse_model(bytes, "m").judge, forest.judge);
  EXPECT_TRUE(parse_model(serialise_model(random_forest(4)), "m").judge.empty());
  forest.judge.features = 1;
  EXPECT_THAT([&] { serialise_model(forest); }, ThrowsMessage<Error>(HasSubstr("judge of people asks for a feature")));
}

TEST(ModelFile, KeepsTheContext) {
  Forest forest = random_forest(4);
  forest.has_background = true;
  Random random(6, 0);
  test::add_judge(forest, 20, random);
  forest.context = forest.judge;
  forest.context.bias = -1.5F;
  const Forest again = parse_model(serialise_model(forest), "m");
  EXPECT_EQ(again.context, forest.context);
  EXPECT_EQ(again.judge, forest.judge);
  forest.judge = {};
  EXPECT_EQ(parse_model(serialise_model(forest), "m").context, forest.context) << "without a judge";
  Forest without = tiny_forest();
  without.has_background = false;
  without.context = forest.context;
  EXPECT_THAT([&] { serialise_model(without); }, ThrowsMessage<Error>(HasSubstr("without a background class")));
}

TEST(ModelFile, KeepsTheNamesOfWhatContextAndJudgeAskFor) {
  Forest forest = random_forest(4);
  forest.has_background = true;
  Random random(6, 0);
  test::add_judge(forest, 3, random);
  forest.context = forest.judge;
  const std::string without = serialise_model(forest);
  for (int f = 0; f < forest.judge.features; ++f) forest.judge.asks.push_back("kind " + std::to_string(f));
  const std::string bytes = serialise_model(forest);
  const Forest again = parse_model(bytes, "m");
  EXPECT_EQ(again.judge, forest.judge);
  EXPECT_EQ(again.context, forest.context) << "which has no names";
  EXPECT_EQ(serialise_model(parse_model(without, "m")), without) << "files without names stay as they are";
  forest.judge.asks.pop_back();
  EXPECT_THAT([&] { serialise_model(forest); }, ThrowsMessage<Error>(HasSubstr("29 names of 30 features")));
}

TEST(ModelFile, KeepsLogitsAndHeadings) {
  for (const int headings : {0, 8}) {
    Forest forest = random_forest(3);
    Random random(9, 0);
    test::add_logits(forest, headings, random);
    const std::string bytes = serialise_model(forest);
    const Forest again = parse_model(bytes, "m");
    EXPECT_EQ(again.trees, forest.trees);
    EXPECT_EQ(again.logit_unit, forest.logit_unit);
    EXPECT_EQ(again.headings, headings);
    EXPECT_EQ(again.facing, forest.facing);
    EXPECT_EQ(bytes, serialise_model(again));
  }
}

TEST(ModelFile, RefusesDamagedLogits) {
  Forest forest = tiny_forest();
  Random random(9, 0);
  test::add_logits(forest, 8, random);
  const std::string bytes = serialise_model(forest);
  for (std::size_t n = 28; n < bytes.size(); ++n) {
    EXPECT_THROW(parse_model(forged(bytes.substr(0, n), n, ""), "m"), Error) << n;
    const std::string changed = forged(bytes, n, std::string(1, static_cast<char>(bytes[n] ^ 0x55)));
    try {
      const Forest again = parse_model(changed, "m");
      EXPECT_NO_THROW(check(again));
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), StartsWith("m"));
    }
  }
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

TEST(ModelFile, RefusesEveryTruncation) {
  const std::string bytes = serialise_model(tiny_forest());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_THROW(parse_model(std::string_view(bytes).substr(0, n), "m"), Error) << n;
  }
  EXPECT_THROW(parse_model(bytes + '\0', "m"), Error);
}

TEST(ModelFile, RefusesTruncationEvenIfTheHeaderMatches) {
  const std::string bytes = serialise_model(tiny_forest());
  for (std::size_t n = 28; n < bytes.size(); ++n) {
    EXPECT_THROW(parse_model(forged(bytes.substr(0, n), n, ""), "m"), Error) << n;
  }
  EXPECT_THROW(parse_model(forged(bytes + '\0', bytes.size(), ""), "m"), Error);
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

TEST(ModelFile, ChecksTheForestAfterTheChecksum) {
  const std::string bytes = serialise_model(tiny_forest());
  int accepted = 0;
  for (std::size_t n = 28; n < bytes.size(); ++n) {
    for (const char value : {'\0', '\x01', '\x7f', '\xff'}) {
      const std::string changed = forged(bytes, n, {&value, 1});
      try {
        const Forest forest = parse_model(changed, "m");
        EXPECT_NO_THROW(check(forest));
        ++accepted;
      } catch (const Error& e) {
        EXPECT_THAT(e.what(), StartsWith("m"));
      }
    }
  }
  EXPECT_GT(accepted, 0);  // a changed threshold, for example, is a valid forest
}

TEST(ModelFile, SaysWhatIsWrong) {
  const std::string bytes = serialise_model(tiny_forest());
  const auto message = [](const std::string& text) {
    try {
      parse_model(text, "a.forest");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message(""), "a.forest: empty file, expected a vesalius model");
  EXPECT_THAT(message("20\n 1 2 3 4 5\n"), StartsWith("a.forest: not a vesalius model"));
  EXPECT_EQ(message(bytes.substr(0, 11)), "a.forest: truncated model, 11 bytes of the 28 of its header");
  EXPECT_EQ(message(bytes.substr(0, bytes.size() - 1)), "a.forest: truncated model, " +
                                                            std::to_string(bytes.size() - 1) + " of " +
                                                            std::to_string(bytes.size()) + " bytes");
  std::string newer = bytes;
  newer[8] = 3;
  EXPECT_EQ(message(newer), "a.forest: written by a newer version: format 3, this program reads 2");
  std::string other = bytes;
  other[8] = 1;
  EXPECT_EQ(message(other), "a.forest: written by another version: format 1, this program reads 2");
  std::string damaged = bytes;
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  EXPECT_EQ(message(damaged), "a.forest: damaged model, the checksum does not match");
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
  EXPECT_EQ(load_model(path).trees, forest.trees);
  EXPECT_EQ(folder.file_count(), 1U) << "nothing else is left in the folder";
  EXPECT_THAT([] { load_model("/nowhere/m.forest"); }, ThrowsMessage<Error>(HasSubstr("/nowhere/m.forest")));
  EXPECT_THAT([&] { save_model(forest, "/nowhere/m.forest"); }, ThrowsMessage<Error>(HasSubstr("/nowhere/m.forest")));
  EXPECT_THAT([&] { save_model(forest, "/dev/full"); }, ThrowsMessage<Error>(HasSubstr("/dev/full")));
}

}  // namespace
}  // namespace vesalius
