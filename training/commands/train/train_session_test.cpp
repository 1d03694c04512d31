#include "commands/train/train_session.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "commands/train/train_recipe.h"
#include "vesalius/body_model.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TrainSessionTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  static Forest forest_of(const std::string& recipe) {
    Forest forest;
    forest.body = paper_body();
    forest.recipe = recipe;
    return forest;
  }
  static Tree tree_of(std::uint8_t label) {
    Tree tree;
    tree.leaves = {{{label}, {200}}};
    return tree;
  }
  std::string refusal(const std::string& recipe) const {
    try {
      TrainSession session(folder_, forest_of(recipe), false);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
  void put(const std::string& name) const { std::ofstream(fs::path(folder_) / name) << "something"; }

  const std::string folder_ = testing::TempDir() + "/vesalius_train_session_" + std::to_string(::getpid());
};

TEST_F(TrainSessionTest, KeepsTreesForTheNextRun) {
  {
    TrainSession session(folder_, forest_of("a = 1\n"), false);
    EXPECT_FALSE(session.load(3));
    session.save(3, tree_of(7));
  }
  TrainSession again(folder_, forest_of("a = 1\n"), false);
  ASSERT_TRUE(again.load(3));
  EXPECT_EQ(again.load(3)->leaves[0].label[0], 7);
  EXPECT_FALSE(again.load(2));
}

TEST_F(TrainSessionTest, IgnoresDamagedAndForeignTrees) {
  TrainSession session(folder_, forest_of("a = 1\n"), false);
  Forest foreign = forest_of("a = 2\n");
  foreign.trees = {tree_of(1)};
  save_model(foreign, folder_ + "/tree-0000.forest");
  EXPECT_FALSE(session.load(0)) << "of another training";
  put("tree-0001.forest");
  EXPECT_FALSE(session.load(1));
}

TEST_F(TrainSessionTest, RefusesOrDiscardsAnotherRecipe) {
  TrainSession(folder_, forest_of("a = 1\nb = 2\n"), false).save(0, tree_of(1));
  EXPECT_THAT(refusal("a = 1\nb = 3\n"), HasSubstr("(`b = 2` before, now `b = 3`); --restart"));
  TrainSession restarted(folder_, forest_of("a = 1\nb = 3\n"), true);
  EXPECT_FALSE(restarted.load(0));
  EXPECT_EQ(refusal("a = 1\nb = 3\n"), folder_ + ": another process is writing there");
}

TEST_F(TrainSessionTest, RefusesFoldersWithOtherFiles) {
  fs::create_directories(folder_);
  put("thesis.txt");
  EXPECT_THAT(refusal("a = 1\n"), HasSubstr("another file in it, thesis.txt"));
  EXPECT_TRUE(fs::exists(fs::path(folder_) / "thesis.txt"));
}

TEST_F(TrainSessionTest, RemovesItsFolder) {
  TrainSession session(folder_, forest_of("a = 1\n"), false);
  session.save(0, tree_of(1));
  put("tree-0001.forest.tmp.77");
  session.remove();
  EXPECT_FALSE(fs::exists(folder_));
}

TEST(FirstDifference, SkipsTheKey) {
  EXPECT_EQ(first_difference("a\nb\n", "a\nb\n"), "");
  EXPECT_EQ(first_difference("# key 1\na\n", "# key 2\nb\n"), "`a` before, now `b`");
  EXPECT_EQ(first_difference("a\n", "a\nb\n"), "`nothing` before, now `b`");
}

}  // namespace
}  // namespace vesalius::cli
