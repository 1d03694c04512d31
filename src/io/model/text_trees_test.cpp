#include "io/model/text_trees.h"

#include <bzlib.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "io/files/data_file.h"
#include "io/files/test_files.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/forest/tree_walk.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

const FeatureConvention kTextConvention{.offset_unit = 1.F, .reference_focal_px = 640.F};

/// The text as rows of numbers. It is walked by the definition of the format and uses no code of the library.
struct TextTree {
  int height = 0;
  std::vector<std::array<int, 5>> nodes;
  std::vector<int> labels;

  explicit TextTree(const std::string& text) {
    std::istringstream in(text);
    in >> height;
    nodes.resize((std::size_t{1} << height) - 1);
    labels.resize(std::size_t{1} << height);
    for (auto& node : nodes) {
      for (int& value : node) in >> value;
    }
    for (int& label : labels) in >> label;
  }

  int label(const DepthImage& depth, const Camera& camera, int u, int v) const {
    // The scale is the library's fixed-point one, so that a probe on the edge between two pixels is rounded alike.
    const auto scale = [&](float focal) { return std::floor(65536.0 * 1000.0 / 640.0 * focal / depth(u, v)); };
    const double scale_u = std::min(scale(camera.fx), 32.0 * 65536.0);
    const double scale_v = std::min(scale(camera.fy), 32.0 * 65536.0);
    const auto read = [&](int du, int dv) {
      const int pu = u + static_cast<int>(std::floor(du * scale_u / 65536.0 + 0.5));
      const int pv = v + static_cast<int>(std::floor(dv * scale_v / 65536.0 + 0.5));
      const bool inside = pu >= 0 && pv >= 0 && pu < depth.width() && pv < depth.height();
      return inside && depth(pu, pv) != 0 ? static_cast<int>(depth(pu, pv)) : 10000;
    };
    std::size_t at = 0;
    while (at < nodes.size()) {
      const auto& n = nodes[at];
      at = 2 * at + (read(n[0], n[1]) - read(n[2], n[3]) <= n[4] ? 1 : 2);
    }
    return labels[at - nodes.size()];
  }
};

/// Returns the number of pixels whose label differs from the text's.
int differences(const Tree& tree, const TextTree& text, const DepthImage& depth, const Camera& camera, int step) {
  const OffsetScaler scaler(kTextConvention, camera);
  int wrong = 0;
  for (int v = 0; v < depth.height(); v += step) {
    for (int u = 0; u < depth.width(); u += step) {
      if (depth(u, v) == 0) continue;
      const TreeLeaf& leaf = walk(tree, depth, kTextConvention, scaler.at(depth(u, v)), u, v);
      wrong += leaf.probability[0] != 255 || leaf.label[0] != text.label(depth, camera, u, v) ? 1 : 0;
    }
  }
  return wrong;
}

/// Returns smooth hills with holes, which give features of both signs and all sizes.
DepthImage hilly_depth(std::uint64_t seed, int width, int height) {
  Random random(seed);
  const double a = random.uniform(0.02, 0.2);
  const double b = random.uniform(0.02, 0.2);
  DepthImage depth(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const double z = 2200.0 + 900.0 * std::sin(a * u) * std::cos(b * v) + random.normal(0.0, 60.0);
      depth(u, v) = random.below(12) == 0 ? 0 : static_cast<std::uint16_t>(z);
    }
  }
  return depth;
}

/// Returns the text of a tree with padding and with leaves that agree.
std::string random_text(Random& random, int height) {
  std::ostringstream out;
  out << height << '\n';
  const auto offset = [&] { return static_cast<int>(random.below(300)) - 150; };
  for (int n = 0; n < (1 << height) - 1; ++n) {
    if (random.below(3) == 0) {
      out << "    0     0     0     0    -1\n";
    } else if (random.below(8) == 0) {
      out << "5 6 5 6 0\n";  // both probes are the same pixel, so every pixel goes left
    } else {
      out << offset() << ' ' << offset() << "  " << offset() << ' ' << offset() << ' '
          << static_cast<int>(random.below(400)) - 200 << '\n';
    }
  }
  for (int l = 0; l < (1 << height); ++l) out << random.below(4) << '\n';
  return out.str();
}

TEST(TextTree, ReadsTheFormatAsDefined) {
  const Tree tree = parse_text_tree("1\n 10 -20  0 0  -5\n7\n8\n", "t");
  ASSERT_EQ(tree.nodes.size(), 1U);
  EXPECT_EQ(tree.nodes[0], (TreeNode{.du1 = 10, .dv1 = -20, .threshold_mm = -5, .left = ~0, .right = ~1}));
  ASSERT_EQ(tree.leaves.size(), 2U);
  EXPECT_EQ(tree.leaves[1], (TreeLeaf{.label = {8}, .probability = {255}}));
}

TEST(TextTree, LosesPaddingAndAgreeingBranches) {
  EXPECT_TRUE(parse_text_tree("1\n1 2 3 4 5\n7\n7\n", "agree").nodes.empty());
  const Tree padded = parse_text_tree("1\n0 0 0 0 -1\n7\n8\n", "padded");
  EXPECT_TRUE(padded.nodes.empty());
  EXPECT_EQ(padded.leaves[0].label[0], 8);
  EXPECT_EQ(parse_text_tree("0\n9\n", "leaf").leaves[0].label[0], 9);
}

TEST(TextTree, LabelsEveryPixelAsBeforePruning) {
  Random random(11);
  const Camera camera{80, 60, 160.F, 150.F, 39.5F, 29.5F};
  for (int i = 0; i < 40; ++i) {
    const std::string text = random_text(random, static_cast<int>(random.below(9)));
    const Tree tree = parse_text_tree(text, "t");
    EXPECT_EQ(differences(tree, TextTree(text), hilly_depth(random.next(), 80, 60), camera, 1), 0) << text;
  }
}

TEST(TextTree, NamesTheLineAndWhatWasExpected) {
  const auto parse = [](const char* text) { return [text] { parse_text_tree(text, "t.txt"); }; };
  EXPECT_THAT(parse(""), ThrowsMessage<Error>("t.txt:1: expected height of the tree, found the end of the file"));
  EXPECT_THAT(parse("x"), ThrowsMessage<Error>(StartsWith("t.txt:1: height of the tree: expected a whole number")));
  EXPECT_THAT(parse("23\n"), ThrowsMessage<Error>(HasSubstr("from 0 to 22")));
  EXPECT_THAT(parse("22\n1 2 3 4 5\n"), ThrowsMessage<Error>(HasSubstr("too few for a tree of height 22")));
  EXPECT_THAT(parse("1\n1 2 3 x 5\n7\n8\n"), ThrowsMessage<Error>(StartsWith("t.txt:2: offset")));
  EXPECT_THAT(parse("1\n1 2 3 4096 5\n7\n8\n"), ThrowsMessage<Error>(StartsWith("t.txt:2: offset")));
  EXPECT_THAT(parse("1\n1 2 3 4 40000\n7\n8\n"), ThrowsMessage<Error>(StartsWith("t.txt:2: threshold")));
  EXPECT_THAT(parse("1\n1 2 3 4 5.5\n7\n8\n"), ThrowsMessage<Error>(StartsWith("t.txt:2: label")));
  EXPECT_THAT(parse("1\n1 2 3 4 5\n7\n255\n"), ThrowsMessage<Error>(StartsWith("t.txt:4: label")));
  EXPECT_THAT(parse("1\n100 200 300 400 5\n7\n"),
              ThrowsMessage<Error>("t.txt:4: expected label, found the end of the file"));
  EXPECT_THAT(parse("1\n1 2 3 4 5\n7\n8\n9\n"), ThrowsMessage<Error>(StartsWith("t.txt:5: expected the end")));
}

class TextTreeFiles : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    return test::put(folder_ / name, bytes);
  }
  static std::string pack(std::string text) {
    std::string packed(text.size() + 1000, '\0');
    auto size = static_cast<unsigned>(packed.size());
    BZ2_bzBuffToBuffCompress(packed.data(), &size, text.data(), static_cast<unsigned>(text.size()), 1, 0, 0);
    return packed.substr(0, size);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(TextTreeFiles, GiveTheSameTreesPlainAndCompressed) {
  const std::string text = "1\n1 2 3 4 5\n7\n8\n";
  const std::string half = "1\n1 2 3";
  const Forest forest = import_text_trees({write("a.txt", text), write("b.txt.bz2", pack(text)),
                                           write("c.bz2", pack(half) + pack(text.substr(half.size())))});
  ASSERT_EQ(forest.trees.size(), 3U);
  EXPECT_EQ(forest.trees[0], forest.trees[1]);
  EXPECT_EQ(forest.trees[0], forest.trees[2]);
  EXPECT_EQ(forest.convention, kTextConvention);
  EXPECT_FALSE(forest.has_background);
  EXPECT_EQ(forest.recipe, "text trees: a.txt b.txt.bz2 c.bz2");
}

TEST_F(TextTreeFiles, RefuseDamagedCompressionAndUnknownLabels) {
  const std::string packed = pack("1\n1 2 3 4 5\n7\n8\n");
  const std::string cut = write("cut.bz2", packed.substr(0, packed.size() - 4));
  EXPECT_THAT([&] { import_text_trees({cut}); }, ThrowsMessage<Error>(cut + ": truncated bzip2 data"));
  std::string wrong = packed;
  wrong[packed.size() / 2] = static_cast<char>(wrong[packed.size() / 2] ^ 0x55);
  EXPECT_THROW(import_text_trees({write("wrong.bz2", wrong)}), Error);
  const std::string label = write("label.txt", "0\n25\n");
  EXPECT_THAT([&] { import_text_trees({label}); }, ThrowsMessage<Error>(label + ": label 25, expected 0 to 24"));
  EXPECT_THROW(import_text_trees({}), Error);
}

fs::path shared_folder() {
  const char* set = std::getenv("VESALIUS_SHARED");
  return set != nullptr ? fs::path(set) : fs::path(VESALIUS_SOURCE_DIR) / "../shared";
}

std::string unpacked(const fs::path& path) {
  const std::string packed = read_file(path.string());
  std::string text(40U << 20U, '\0');
  auto size = static_cast<unsigned>(text.size());
  EXPECT_EQ(BZ2_bzBuffToBuffDecompress(text.data(), &size, const_cast<char*>(packed.data()),
                                       static_cast<unsigned>(packed.size()), 0, 0),
            BZ_OK);
  return text.substr(0, size);
}

// Labels: real
TEST(ReleasedTrees, GiveEveryPixelTheLabelOfTheText) {
  const fs::path reference = shared_folder() / "reference";
  if (!fs::exists(reference)) GTEST_SKIP() << "needs the released trees in " << reference;
  for (const char* name : {"pcl_tree_1.txt.bz2", "pcl_tree_2.txt.bz2", "pcl_tree_3.txt.bz2"}) {
    const Forest forest = import_text_trees({(reference / name).string()});
    const Tree& tree = forest.trees[0];
    const TextTree text(unpacked(reference / name));
    const Camera camera{160, 120, 150.F, 150.F, 79.5F, 59.5F};
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      EXPECT_EQ(differences(tree, text, hilly_depth(seed, 160, 120), camera, 1), 0) << name;
    }
    for (const char* set : {"alina_wave", "uc3m", "fallseq"}) {
      const auto source = open_source((shared_folder() / "real" / set).string());
      const auto frame = source->next();
      ASSERT_TRUE(frame) << set;
      EXPECT_EQ(differences(tree, text, frame->depth, frame->camera, 3), 0) << name << ' ' << set;
    }
    EXPECT_LT(tree.nodes.size(), text.nodes.size() / 2) << "padding is most of the text";
  }
}

}  // namespace
}  // namespace vesalius
