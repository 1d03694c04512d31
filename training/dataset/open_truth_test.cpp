#include "dataset/open_truth.h"

#include "dataset/test_dataset.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> names(TruthSource& source) {
  std::vector<std::string> found;
  while (const auto frame = source.next()) found.push_back(frame->frame.name);
  return found;
}

/// Writes five frames f0 to f4 with a table of people.
void put_frames(const test::TemporaryFolder& folder) {
  std::string table = "frame,people\n";
  for (int i = 0; i < 5; ++i) {
    const std::string name = "f" + std::to_string(i);
    test::put(folder / "depth/" + name + ".png", encode_png(DepthImage(6, 4, static_cast<std::uint16_t>(1000 + i))));
    table += name + "," + std::to_string(i) + "\n";
  }
  test::put(folder / "frames.csv", table);
  test::put(folder / "meta.json", R"({"fx": 5, "fy": 5, "cx": 2.5, "cy": 1.5, "width": 6, "height": 4})");
}

std::unique_ptr<TruthSource> sequences(const std::string& folder) {
  return open_sequences(folder, [](const std::string& path) { return open_truth(path); });
}

TEST(OpenTruth, OpensFramesOfAFolder) {
  const test::TemporaryFolder folder;
  put_frames(folder);
  const auto source = open_truth(folder.path());
  EXPECT_EQ(source->size(), 5);
  const auto first = source->next();
  EXPECT_EQ(first->frame.name, "f0");
  EXPECT_EQ(first->truth.people, 0);
  EXPECT_EQ(source->next()->truth.people, 1);
  EXPECT_THAT(names(*source), ElementsAre("f2", "f3", "f4"));
  EXPECT_THAT(names(*open_truth("folder:" + folder.path())), ElementsAre("f0", "f1", "f2", "f3", "f4"));
}

TEST(OpenTruth, GivesEveryNthFrame) {
  const test::TemporaryFolder folder;
  put_frames(folder);
  const auto source = open_truth(folder.path(), 2);
  EXPECT_EQ(source->size(), 3);
  EXPECT_THAT(names(*source), ElementsAre("f0", "f2", "f4"));
  EXPECT_THROW(open_truth(folder.path(), 0), UsageError);
}

TEST(OpenTruth, GoesOnAfterADamagedFrame) {
  const test::TemporaryFolder folder;
  put_frames(folder);
  test::put(folder / "depth/f1.png", "no picture");
  const auto source = open_truth(folder.path());
  EXPECT_EQ(source->next()->frame.name, "f0");
  EXPECT_THAT(test::error_of([&] { source->next(); }), HasSubstr("f1.png"));
  EXPECT_THAT(names(*source), ElementsAre("f2", "f3", "f4"));
}

TEST(OpenTruth, OpensDatasets) {
  const test::TemporaryFolder folder;
  std::vector<LabelledFrame> frames;
  {
    DatasetWriter writer(folder / "set", test::small_info(5, 2));
    for (std::uint64_t i = 0; i < 5; ++i) {
      frames.push_back(test::random_labelled(i));
      writer.write(i, frames.back());
    }
  }
  const auto source = open_truth(folder / "set", 3);
  EXPECT_EQ(source->size(), 2);
  EXPECT_EQ(source->part_names().at(10), "neck");
  source->next();
  const auto fourth = source->next();
  ASSERT_TRUE(fourth);
  EXPECT_EQ(fourth->frame.depth, frames[3].frame.depth);
  EXPECT_EQ(fourth->truth.labels, frames[3].labels);
  EXPECT_EQ(fourth->truth.person, frames[3].person);
  EXPECT_EQ(fourth->truth.people, 2);
  EXPECT_EQ(fourth->truth.parts[0], frames[3].parts[0]);
  EXPECT_TRUE(fourth->truth.joints.empty());  // these joints are of another skeleton
  for (std::size_t i = 0; i < fourth->truth.mask.size(); ++i) {
    ASSERT_EQ(fourth->truth.mask[i] != 0, frames[3].person[i] != kBackground);
  }
  EXPECT_FALSE(source->next());
}

TEST(OpenTruth, RefusesFramesWithoutTruth) {
  const test::TemporaryFolder folder;
  put_frames(folder);
  std::filesystem::remove(folder / "frames.csv");
  EXPECT_THAT(test::error_of([&] { open_truth(folder.path()); }), HasSubstr("no truth"));
  EXPECT_THAT(test::error_of([&] { open_truth("/nowhere"); }), HasSubstr("/nowhere"));
}

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

TEST(OpenSequences, FindsFoldersOfFramesWithTruth) {
  const test::TemporaryFolder folder;
  put_recording(folder / "walk_10", 1);
  put_recording(folder / "walk_9", 1);
  test::put(folder / "without_truth/depth/a.png", "");
  test::put(folder / "without_frames/joints.csv", "");
  EXPECT_THAT(names(*sequences(folder.path())), ElementsAre("walk_9/0", "walk_10/0"));
  EXPECT_THAT(names(*sequences(folder / "walk_9")), ElementsAre("0"));
  EXPECT_THAT(test::error_of([&] { sequences(folder / "without_truth"); }), HasSubstr("without_truth"));
  EXPECT_THAT(test::error_of([&] { sequences("/nowhere"); }), HasSubstr("/nowhere"));
}

TEST(OpenSequences, GivesOneRecordingAfterTheOther) {
  const test::TemporaryFolder folder;
  put_recording(folder / "a", 3);
  put_recording(folder / "b", 2);
  const auto frames = sequences(folder.path());
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

TEST(OpenSequences, LeavesARecording) {
  const test::TemporaryFolder folder;
  put_recording(folder / "a", 3);
  put_recording(folder / "b", 2);
  const auto frames = sequences(folder.path());
  frames->next();
  frames->leave_sequence();
  EXPECT_EQ(frames->next()->frame.name, "b/0");
}

TEST(OpenSequences, NamesASourceThatCannotBeOpened) {
  const test::TemporaryFolder folder;
  put_recording(folder / "a", 1);
  put_recording(folder / "gone", 1);
  const auto frames = sequences(folder.path());
  frames->next();
  std::filesystem::remove_all(folder / "gone");
  EXPECT_THAT(test::error_of([&] { frames->next(); }), HasSubstr("gone"));
}

}  // namespace

}  // namespace vesalius
