#include "view/source_choice.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "io/files/test_files.h"
#include "io/sources/write_frames.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::put;
using testing::ElementsAre;
using testing::HasSubstr;

void write_frames(const std::string& folder) {
  const auto writer = make_frame_writer(FrameFormat::folder, folder);
  for (const char* name : {"0001", "0002"}) writer->write(test::random_frame(name, 1));
  writer->close();
}

/// A folder "in" with sources, beside a folder "out" with frames and a recording that nobody is to reach.
class SourceChoices : public testing::Test {
 protected:
  SourceChoices() {
    write_frames(folder_ / "in/walk");
    write_frames(folder_ / "out/secret");
    put(folder_ / "in/b.mcap", "1234");
    put(folder_ / "in/split/one.bag", "");
    put(folder_ / "in/split/two.bag", "");
    put(folder_ / "in/notes.txt", "");
    put(folder_ / "in/.hidden/a.mcap", "");
    put(folder_ / "out/a.mcap", "");
  }
  void link(const std::string& to, const std::string& from) { fs::create_symlink(folder_ / to, folder_ / from); }
  SourceChoice choice() const {
    return SourceChoice(folder_ / "in", [] { return std::vector<SensorInfo>(); });
  }
  static std::vector<std::string> texts(const ChoiceList& list) {
    std::vector<std::string> all;
    for (const ChoiceEntry& entry : list.entries) {
      all.push_back(entry.name + (entry.is_folder ? "/" : "") + (entry.opens ? " opens" : ""));
    }
    return all;
  }

  test::TemporaryFolder folder_;
};

TEST_F(SourceChoices, ListRecordingsAndFolders) {
  const ChoiceList list = choice().list("");
  EXPECT_THAT(texts(list), ElementsAre("b.mcap opens", "split/", "walk/ opens"));
  EXPECT_EQ(list.entries[0].bytes, 4U);
  EXPECT_EQ(list.left_out, 0);
  const ChoiceList below = choice().list("split");
  EXPECT_EQ(below.folder, "split");
  EXPECT_THAT(texts(below), ElementsAre("one.bag opens", "two.bag opens"));
  EXPECT_THAT(error_of([&] { (void)choice().list("b.mcap"); }), HasSubstr("b.mcap: "));
}

TEST_F(SourceChoices, ListAThousandEntriesAndCountTheRest) {
  for (int i = 0; i < 1005; ++i) put(folder_ / ("in/many/" + std::to_string(i) + ".mkv"), "");
  const ChoiceList list = choice().list("many");
  EXPECT_EQ(list.entries.size(), 1000U);
  EXPECT_EQ(list.left_out, 5);
}

TEST_F(SourceChoices, GivePathsBelowTheFolder) {
  EXPECT_EQ(open_source(choice().source("walk"))->size(), 2);
  EXPECT_EQ(choice().source("./walk/"), fs::canonical(folder_ / "in/walk"));
  link("in/walk", "in/again");
  EXPECT_EQ(open_source(choice().source("again"))->size(), 2) << "a link that stays inside";
  EXPECT_THAT(texts(choice().list("")), testing::Contains("again/ opens"));
}

TEST_F(SourceChoices, RefuseWhatLiesOutside) {
  link("out/a.mcap", "in/file.mcap");
  link("out", "in/folder");
  write_frames(folder_ / "in/mixed");
  link("out/secret/depth/0001.png", "in/mixed/depth/0003.png");
  const std::string below = ", expected what lies below " + fs::canonical(folder_ / "in").string();
  using Refused = std::pair<std::string, std::string>;
  for (const Refused& refused :
       std::vector<Refused>{{folder_ / "in/walk", "an absolute path"},
                            {"/etc", "an absolute path"},
                            {"..", "a path with \"..\""},
                            {"../out/secret", "a path with \"..\""},
                            {"walk/../../out/a.mcap", "a path with \"..\""},
                            {"file.mcap", "a link that leads out"},
                            {"folder", "a link that leads out"},
                            {"folder/secret", "a link that leads out"},
                            {"tum:walk", "No such file or directory"},
                            {"folder:" + (folder_ / "out/secret"), "No such file or directory"},
                            {"nothing", "No such file or directory"}}) {
    const std::string& wish = refused.first;
    const auto is_told = testing::AllOf(testing::StartsWith(wish + ": " + refused.second), testing::EndsWith(below));
    EXPECT_THAT(error_of([&] { (void)choice().source(wish); }), is_told);
    EXPECT_THAT(error_of([&] { (void)choice().list(wish); }), is_told);
  }
  EXPECT_EQ(error_of([&] { (void)choice().source("mixed"); }), "mixed/depth/0003.png: a link that leads out" + below);
  EXPECT_THAT(texts(choice().list("")), ElementsAre("b.mcap opens", "mixed/ opens", "split/", "walk/ opens"));
}

TEST_F(SourceChoices, GiveCamerasThatArePluggedInAlone) {
  const SourceChoice choice(folder_ / "in", [] { return std::vector<SensorInfo>{{"realsense:12", "D435"}}; });
  EXPECT_EQ(choice.source("realsense:12"), "realsense:12");
  // The driver would play a file of this name.
  const std::string file = "realsense:" + (folder_ / "out/a.mcap");
  EXPECT_THAT(error_of([&] { (void)choice.source(file); }), HasSubstr("not plugged in"));
}

TEST(SourceChoice, WithoutAFolderThereIsNone) {
  EXPECT_THAT(error_of([] { SourceChoice("/no/such"); }), HasSubstr("/no/such: no such folder"));
}

}  // namespace
}  // namespace vesalius
