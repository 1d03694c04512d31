#include "dataset/truth_sequences.h"

#include "dataset/open_truth.h"
#include "dataset/test_dataset.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Writes frames 0, 1, ... of one person.
void put_recording(const std::string& folder, int frames) {
  std::string table = "frame,people\n";
  for (int i = 0; i < frames; ++i) {
    test::put(folder + "/depth/" + std::to_string(i) + ".png", encode_png(DepthImage(6, 4, 1000)));
    table += std::to_string(i) + ",1\n";
  }
  test::put(folder + "/frames.csv", table);
  test::put(folder + "/meta.json", R"({"fx": 5, "rate_hz": 10})");
}

TEST(SequencesIn, FindsFoldersOfFramesWithTruth) {
  const test::TemporaryFolder folder;
  put_recording(folder / "walk_10", 1);
  put_recording(folder / "walk_9", 1);
  test::put(folder / "without_truth/depth/a.png", "");
  test::put(folder / "without_frames/joints.csv", "");
  EXPECT_THAT(sequences_in(folder.path()), ElementsAre(folder / "walk_9", folder / "walk_10"));
  EXPECT_THAT(sequences_in(folder / "walk_9"), ElementsAre(folder / "walk_9"));
  EXPECT_THAT(sequences_in(folder / "without_truth"), ElementsAre(folder / "without_truth"));
  EXPECT_THAT(sequences_in("/nowhere"), ElementsAre("/nowhere"));
}

TEST(JoinedTruth, GivesOneRecordingAfterTheOther) {
  const test::TemporaryFolder folder;
  put_recording(folder / "a", 3);
  put_recording(folder / "b", 2);
  const auto open = [](const std::string& path) { return open_truth(path); };
  const auto frames = joined_truth(sequences_in(folder.path()), open);
  std::vector<std::string> names;
  std::vector<int> sequences;
  while (const auto frame = frames->next()) {
    names.push_back(frame->frame.name);
    sequences.push_back(frame->truth.sequence);
    EXPECT_THAT(frame->truth.ids, ElementsAre(0));
  }
  EXPECT_THAT(names, ElementsAre("a/0", "a/1", "a/2", "b/0", "b/1"));
  EXPECT_EQ(sequences[0], sequences[2]);
  EXPECT_LT(sequences[2], sequences[3]);
  EXPECT_EQ(sequences[3], sequences[4]);
}

TEST(JoinedTruth, LeavesARecording) {
  const test::TemporaryFolder folder;
  put_recording(folder / "a", 3);
  put_recording(folder / "b", 2);
  const auto frames =
      joined_truth(sequences_in(folder.path()), [](const std::string& path) { return open_truth(path); });
  frames->next();
  frames->leave_sequence();
  EXPECT_EQ(frames->next()->frame.name, "b/0");
}

TEST(JoinedTruth, NamesASourceThatCannotBeOpened) {
  const test::TemporaryFolder folder;
  put_recording(folder / "a", 1);
  const auto open = [](const std::string& path) { return open_truth(path); };
  const auto frames = joined_truth({folder / "a", folder / "gone"}, open);
  frames->next();
  EXPECT_THAT(test::error_of([&] { frames->next(); }), HasSubstr("gone"));
}

}  // namespace
}  // namespace vesalius
