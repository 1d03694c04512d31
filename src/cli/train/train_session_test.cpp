#include "cli/train/train_session.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "cli/train/train_recipe.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TrainSessionTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  static Forest forest_of(std::uint8_t label, const std::string& recipe) {
    Forest forest;
    forest.body = paper_body();
    forest.recipe = recipe;
    forest.trees.resize(1);
    forest.trees[0].leaves = {{{label}, {200}}};
    return forest;
  }
  std::string refusal(const std::string& recipe) const {
    try {
      TrainSession session(folder_, recipe, false);
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
    const TrainSession session(folder_, "a = 1\n", false);
    EXPECT_FALSE(session.load(3));
    session.save(3, forest_of(7, "a = 1\n"));
  }
  const TrainSession again(folder_, "a = 1\n", false);
  ASSERT_TRUE(again.load(3));
  EXPECT_EQ(again.load(3)->leaves[0].label[0], 7);
  EXPECT_FALSE(again.load(2));
}

TEST_F(TrainSessionTest, DamagedAndForeignTreesAreNotThere) {
  const TrainSession session(folder_, "a = 1\n", false);
  session.save(0, forest_of(1, "a = 2\n"));
  EXPECT_FALSE(session.load(0)) << "of another training";
  put("tree-0001.forest");
  EXPECT_FALSE(session.load(1));
}

TEST_F(TrainSessionTest, AnotherRecipeIsRefusedOrForgotten) {
  TrainSession(folder_, "a = 1\nb = 2\n", false).save(0, forest_of(1, "a = 1\nb = 2\n"));
  EXPECT_THAT(refusal("a = 1\nb = 3\n"), HasSubstr("(`b = 2` before, now `b = 3`); --restart"));
  const TrainSession restarted(folder_, "a = 1\nb = 3\n", true);
  EXPECT_FALSE(restarted.load(0));
  EXPECT_EQ(refusal("a = 1\nb = 3\n"), folder_ + ": another process is writing there");
}

TEST_F(TrainSessionTest, LeavesFoldersOfOthersAlone) {
  fs::create_directories(folder_);
  put("thesis.txt");
  EXPECT_THAT(refusal("a = 1\n"), HasSubstr("another file in it, thesis.txt"));
  EXPECT_TRUE(fs::exists(fs::path(folder_) / "thesis.txt"));
}

TEST_F(TrainSessionTest, RemovesWhatItMade) {
  TrainSession session(folder_, "a = 1\n", false);
  session.save(0, forest_of(1, "a = 1\n"));
  put("tree-0001.forest.tmp.77");
  session.remove();
  EXPECT_FALSE(fs::exists(folder_));
}

TEST(FirstDifference, PassesOverTheKey) {
  EXPECT_EQ(first_difference("a\nb\n", "a\nb\n"), "");
  EXPECT_EQ(first_difference("# key 1\na\n", "# key 2\nb\n"), "`a` before, now `b`");
  EXPECT_EQ(first_difference("a\n", "a\nb\n"), "`nothing` before, now `b`");
}

}  // namespace
}  // namespace vesalius::cli
