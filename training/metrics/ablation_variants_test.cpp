#include "metrics/ablation_variants.h"

#include <gmock/gmock.h>

#include "vesalius/base/body_model.h"
#include "vesalius/forest/body_context.h"

namespace vesalius {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;

Forest forest_of(int trees, TreeLeaf leaf) {
  Forest forest;
  forest.body = paper_body();
  forest.trees.resize(trees);
  for (Tree& tree : forest.trees) tree.leaves = {leaf};
  return forest;
}

std::vector<std::string> names(const std::vector<Variant>& variants) {
  std::vector<std::string> found;
  for (const Variant& variant : variants) found.push_back(variant.name);
  return found;
}

const FrameScorer& find(const std::vector<Variant>& variants, const std::string& name) {
  for (const Variant& variant : variants) {
    if (variant.name == name) return *variant.scorer;
  }
  throw std::runtime_error(name);
}

TEST(AblationVariants, ChangeOneThingEach) {
  Forest forest = forest_of(5, {{3, 4}, {200, 50}});
  forest.has_background = true;
  const DetectOptions options;
  const auto variants = ablation_variants(forest, {options});
  EXPECT_THAT(
      names(variants),
      ElementsAre("no second iteration", "look by depth alone", "look by colour alone", "look by depth and texture",
                  "no smoothing", "smoothing by mode", "no links past unseen parts", "roots of the body alone",
                  "proposals with the labels' background", "forest asked everywhere", "every pixel",
                  "every second pixel", "root neck alone", "root l_face_bottom alone", "root r_face_bottom alone",
                  "votes, smoothed by mode", "1 tree", "2 trees", "4 trees"));
  EXPECT_FALSE(find(variants, "no second iteration").options().detect.refine.second_pass);
  EXPECT_EQ(find(variants, "no second iteration").options().detect.grow.appearance, "hue");
  EXPECT_EQ(find(variants, "look by depth alone").options().detect.grow.appearance, "none");
  EXPECT_EQ(find(variants, "look by depth and texture").options().detect.grow.appearance, "texture");
  EXPECT_TRUE(find(variants, "smoothing by mode").options().detect.smooth.mode);
  EXPECT_FALSE(find(variants, "no links past unseen parts").options().detect.search.grandparents);
  EXPECT_FALSE(find(variants, "roots of the body alone").options().detect.search.any_root);
  EXPECT_EQ(find(variants, "proposals with the labels' background").options().detect.label.proposal_weight,
            options.label.background_weight);
  EXPECT_GT(find(variants, "forest asked everywhere").options().detect.label.gate, 1.F);
  EXPECT_EQ(find(variants, "every pixel").options().detect.grid.step, 1);
  EXPECT_EQ(find(variants, "every second pixel").options().detect.grid.step, 2);
  EXPECT_EQ(find(variants, "root neck alone").body().roots.size(), 1U);
  EXPECT_FALSE(find(variants, "root neck alone").options().detect.search.any_root);
  EXPECT_TRUE(find(variants, "1 tree").options().detect.refine.second_pass);
}

TEST(AblationVariants, LeaveOutChangesWithoutEffect) {
  DetectOptions options;
  options.refine.second_pass = false;
  options.grow.appearance = "none";
  options.smooth.window = 1;
  options.search.grandparents = false;
  options.search.any_root = false;
  options.grid.step = 2;
  Forest votes = forest_of(2, {{3}, {255}});
  votes.body.roots.resize(1);
  EXPECT_THAT(names(ablation_variants(votes, {options})),
              ElementsAre("second iteration", "look by depth and hue", "look by depth and texture",
                          "links past unseen parts", "any part as root", "every pixel", "1 tree"));
}

TEST(AblationVariants, LeaveOutTheContext) {
  Forest forest = forest_of(2, {{3, 4}, {200, 50}});
  forest.has_background = true;
  EXPECT_THAT(names(ablation_variants(forest, {})), Not(Contains("each pixel by itself")));
  forest.context = {BodySurroundings::feature_count(forest.body), 0.F, {BoostedTree{}}};
  EXPECT_THAT(names(ablation_variants(forest, {})), Contains("each pixel by itself"));
}

}  // namespace
}  // namespace vesalius
