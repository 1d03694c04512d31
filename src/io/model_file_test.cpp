#include "io/model_file.h"

#define XXH_INLINE_ALL
#include <gmock/gmock.h>
#include <xxhash.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "vesalius/error.h"
#include "vesalius/random.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

std::int16_t random_int16(Random& random, int bound) {
  return static_cast<std::int16_t>(static_cast<int>(random.below(static_cast<std::uint32_t>(2 * bound + 1))) - bound);
}

TreeLeaf random_leaf(Random& random, int classes) {
  TreeLeaf leaf;
  const std::uint32_t used = 1 + random.below(TreeLeaf::kClasses);
  for (std::size_t k = 0; k < used; ++k) {
    leaf.label[k] = static_cast<std::uint8_t>(random.below(static_cast<std::uint32_t>(classes)));
    leaf.probability[k] = used == 1 ? 255 : static_cast<std::uint8_t>(1 + random.below(60));
  }
  return leaf;
}

/// Nodes whose children are any later node or any leaf: every shape that check() allows.
Tree random_tree(Random& random, std::uint32_t nodes, std::uint32_t leaves, int classes) {
  Tree tree;
  const auto child = [&](std::uint32_t parent) {
    const bool inner = parent + 1 < nodes && random.below(2) == 0;
    if (!inner) return ~static_cast<std::int32_t>(random.below(leaves));
    return static_cast<std::int32_t>(parent + 1 + random.below(nodes - parent - 1));
  };
  for (std::uint32_t n = 0; n < nodes; ++n) {
    TreeNode node;
    for (std::int16_t* value : {&node.du1, &node.dv1, &node.du2, &node.dv2}) *value = random_int16(random, kMaxOffset);
    node.threshold_mm = random_int16(random, 32767);
    node.left = child(n);
    node.right = child(n);
    tree.nodes.push_back(node);
  }
  for (std::uint32_t l = 0; l < leaves; ++l) tree.leaves.push_back(random_leaf(random, classes));
  return tree;
}

Forest random_forest(std::uint64_t seed, std::uint32_t nodes = 200) {
  Random random(seed);
  Forest forest;
  forest.body = paper_body();
  forest.has_background = random.below(2) == 0;
  forest.convention = {.offset_unit = 0.25F, .hole_mm = 65535, .outside_mm = 1, .clip_mm = 300};
  forest.recipe = "random " + std::to_string(seed);
  for (int t = 0; t < 3; ++t) forest.trees.push_back(random_tree(random, nodes, nodes + 1, forest.class_count()));
  forest.trees.push_back({.nodes = {}, .leaves = {random_leaf(random, 25)}});
  return forest;
}

/// A forest small enough to try every byte of its file.
Forest tiny_forest() {
  Forest forest = random_forest(3, 5);
  forest.body = parse_body_model(R"(name = "one"
roots = ["all"]
[[part]]
name = "all"
colour = [0, 0, 0]
mirror = "all"
max_extent = 1
area = 1
upper_body = true
)",
                                 "one");
  for (Tree& tree : forest.trees) {
    for (TreeLeaf& leaf : tree.leaves) leaf.label = {};
  }
  return forest;
}

/// Overwrites bytes and makes the checksum fit again: what only a forger, or a bug, writes.
std::string forged(std::string bytes, std::size_t at, std::string_view with) {
  bytes.replace(at, with.size(), with);
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 12, &size, 8);
  std::string hashed = bytes.substr(0, 20) + bytes.substr(28);
  const std::uint64_t sum = XXH64(hashed.data(), hashed.size(), 0);
  std::memcpy(bytes.data() + 20, &sum, 8);
  return bytes;
}

TEST(ModelFile, RoundTripKeepsEverything) {
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

TEST(ModelFile, SameForestSameBytes) {
  const std::string bytes = serialise_model(random_forest(5));
  EXPECT_EQ(bytes, serialise_model(random_forest(5)));
  EXPECT_EQ(bytes, serialise_model(parse_model(bytes, "m")));
  EXPECT_EQ(model_checksum(bytes).size(), 16U);
  EXPECT_NE(model_checksum(bytes), model_checksum(serialise_model(random_forest(6))));
}

TEST(ModelFile, LabelsOfUnusedSlotsDoNotReachTheFile) {
  Forest forest = random_forest(5);
  forest.trees.back().leaves[0] = {.label = {1, 0, 0, 9}, .probability = {255, 0, 0, 0}};
  const std::string bytes = serialise_model(forest);
  forest.trees.back().leaves[0].label[3] = 0;
  EXPECT_EQ(bytes, serialise_model(forest));
}

TEST(ModelFile, EveryTruncationIsRefused) {
  const std::string bytes = serialise_model(tiny_forest());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_THROW(parse_model(std::string_view(bytes).substr(0, n), "m"), Error) << n;
  }
  EXPECT_THROW(parse_model(bytes + '\0', "m"), Error);
}

TEST(ModelFile, EveryChangedByteIsRefused) {
  const std::string bytes = serialise_model(tiny_forest());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string changed = bytes;
      changed[n] = static_cast<char>(changed[n] ^ flip);
      EXPECT_THROW(parse_model(changed, "m"), Error) << n;
    }
  }
}

TEST(ModelFile, WhatPassesTheChecksumIsStillChecked) {
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
  EXPECT_GT(accepted, 0);  // e.g. another threshold
}

TEST(ModelFile, CountsBeyondTheFileAreRefusedBeforeAllocation) {
  Forest forest = tiny_forest();
  forest.trees = {{.nodes = {}, .leaves = {TreeLeaf{.label = {}, .probability = {255}}}}};
  const std::string bytes = serialise_model(forest);
  const std::size_t nodes_at = bytes.size() - 2 - 8;
  for (const std::size_t at : {nodes_at - 4, nodes_at, nodes_at + 4}) {
    EXPECT_THAT([&] { parse_model(forged(bytes, at, "\xff\xff\xff\xff"), "m"); },
                ThrowsMessage<Error>(HasSubstr("4294967295")));
  }
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
  newer[8] = 2;
  EXPECT_EQ(message(newer), "a.forest: written by a newer version: format 2, this program reads up to 1");
  std::string damaged = bytes;
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  EXPECT_EQ(message(damaged), "a.forest: damaged model, the checksum does not match");
}

TEST(ModelFile, InconsistentForestIsNotWritten) {
  Forest forest = random_forest(1);
  forest.trees[0].nodes[3].left = 3;
  EXPECT_THROW(serialise_model(forest), Error);
  Forest other = random_forest(1);
  other.body.parts[4].name = "renamed";
  EXPECT_THROW(serialise_model(other), Error);
}

TEST(ModelFile, SavesAndLoads) {
  const fs::path folder = fs::path(testing::TempDir()) / "vesalius_model_file_test";
  fs::create_directories(folder);
  const std::string path = (folder / "m.forest").string();
  const Forest forest = random_forest(8);
  save_model(forest, path);
  EXPECT_EQ(load_model(path).trees, forest.trees);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "nothing else is left in the folder";
  EXPECT_THAT([] { load_model("/nowhere/m.forest"); }, ThrowsMessage<Error>(HasSubstr("/nowhere/m.forest")));
  EXPECT_THAT([&] { save_model(forest, "/nowhere/m.forest"); }, ThrowsMessage<Error>(HasSubstr("/nowhere/m.forest")));
  EXPECT_THAT([&] { save_model(forest, "/dev/full"); }, ThrowsMessage<Error>(HasSubstr("/dev/full")));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace vesalius
