#include "dataset/labelled_dataset.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "dataset/open_truth.h"
#include "dataset/test_dataset.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::random_labelled;
using test::small_info;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void write_missing(DatasetWriter& writer) {
  const std::vector<FrameRange> missing = writer.missing();
  for (const FrameRange& range : missing) {
    for (std::uint64_t i = range.first; i < range.first + range.count; ++i) writer.write(i, random_labelled(i));
  }
}

/// A folder with a complete dataset.
struct Whole {
  test::TemporaryFolder folder;
  explicit Whole(const DatasetInfo& info = small_info()) {
    DatasetWriter writer(path(), info);
    write_missing(writer);
  }
  std::string path() const { return folder / "set"; }
  std::string shard(int i) const { return folder / ("set/00000" + std::to_string(i) + ".shard"); }
};

TEST(Dataset, GivesFramesBackInAnyOrder) {
  const Whole whole;
  EXPECT_TRUE(is_dataset(whole.path()));
  const DatasetReader reader(whole.path());
  EXPECT_EQ(reader.size(), 10U);
  EXPECT_EQ(reader.info().recipe, small_info().recipe);
  EXPECT_EQ(reader.info().seed, 7U);
  EXPECT_EQ(reader.body().part_count(), 25);
  for (const std::uint64_t i : {9U, 0U, 4U, 3U, 7U}) test::expect_same(reader.read(i), random_labelled(i));
  EXPECT_TRUE(reader.read(2, false).frame.colour.empty());
  EXPECT_THAT(error_of([&] { reader.read(10); }), HasSubstr("frame 10, expected one below 10"));
}

TEST(Dataset, NamesTheJointsOfItsPeople) {
  const Whole whole;
  EXPECT_EQ(DatasetReader(whole.path()).info().joints, test::kJoints);
  test::TemporaryFolder folder;
  DatasetInfo info = small_info();
  info.joints.pop_back();
  DatasetWriter writer(folder / "set", info);
  EXPECT_THAT(error_of([&] { writer.write(0, random_labelled(0)); }),
              HasSubstr("person with 3 joints, expected the 2 that the dataset names"));
  EXPECT_THAT(error_of([&] { DatasetWriter(whole.path(), info); }), HasSubstr("another recipe"));
}

TEST(Dataset, HasTheSameBytesAfterAnyInterruption) {
  const Whole whole;
  test::TemporaryFolder folder;
  const std::string path = folder / "set";
  {
    DatasetWriter writer(path, small_info());
    EXPECT_THAT(writer.missing(), ElementsAre(FrameRange{0, 4}, FrameRange{4, 4}, FrameRange{8, 2}));
    for (std::uint64_t i = 4; i < 8; ++i) writer.write(i, random_labelled(i));
    writer.write(0, random_labelled(0));  // this frame is lost, since its shard never fills
  }
  test::put(path + "/000000.shard.tmp123-0", "half a shard of a killed process");
  {
    DatasetWriter writer(path, small_info());
    EXPECT_THAT(writer.missing(), ElementsAre(FrameRange{0, 4}, FrameRange{8, 2}));
    write_missing(writer);
    EXPECT_THAT(writer.missing(), IsEmpty());
  }
  for (const auto& entry : fs::directory_iterator(whole.path())) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(test::get(path + "/" + name), test::get(entry.path().string())) << name;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(path), {}), 4);
}

TEST(Dataset, ReplacesDamagedTruncatedAndForeignShards) {
  const Whole whole;
  const Whole other({paper_body().toml, "people = 3\n", 7, 10, 4, test::kJoints});
  std::string damaged = test::get(whole.shard(0));
  damaged[damaged.size() - 20] ^= 1;
  test::put(whole.shard(0), damaged);
  fs::copy_file(other.shard(1), whole.shard(1), fs::copy_options::overwrite_existing);
  fs::resize_file(whole.shard(2), 100);
  DatasetWriter writer(whole.path(), small_info());
  EXPECT_THAT(writer.missing(), ElementsAre(FrameRange{0, 4}, FrameRange{4, 4}, FrameRange{8, 2}));
  write_missing(writer);
  const DatasetReader reader(whole.path());
  for (std::uint64_t i = 0; i < 10; ++i) test::expect_same(reader.read(i), random_labelled(i));
}

TEST(Dataset, KnowsItsClips) {
  const test::TemporaryFolder folder;
  DatasetInfo info = test::small_info();
  info.clips = {5, 29.97};
  {
    DatasetWriter writer(folder / "set", info);
    for (std::uint64_t i = 0; i < 10; ++i) writer.write(i, random_labelled(i));
  }
  const DatasetReader reader(folder / "set");
  EXPECT_EQ(reader.info().clips, info.clips);
  const auto source = open_truth(folder / "set");
  for (int i = 0; i < 10; ++i) {
    const FrameTruth truth = source->next()->truth;
    EXPECT_EQ(truth.sequence, i / 5);
    EXPECT_THAT(truth.ids, testing::ElementsAre(0, 1));
  }
  info.clips.rate_hz = 30.0;
  EXPECT_THAT(error_of([&] { DatasetWriter(folder / "set", info); }), HasSubstr("another recipe"));
  info.clips = {5, 0.0};
  EXPECT_THROW(DatasetWriter(folder / "other", info), UsageError);
}

TEST(Dataset, CanGrow) {
  const Whole whole;
  DatasetWriter writer(whole.path(), small_info(14));
  EXPECT_THAT(writer.missing(), ElementsAre(FrameRange{8, 4}, FrameRange{12, 2}));
  write_missing(writer);
  EXPECT_EQ(DatasetReader(whole.path()).size(), 14U);
}

TEST(Dataset, TakesFramesEncodedElsewhere) {
  test::TemporaryFolder folder;
  DatasetWriter writer(folder / "set", small_info(1));
  EXPECT_THAT(error_of([&] {
                writer.write_encoded(0, encode_frame({1, 7, random_labelled(0)}, 25));
              }),
              HasSubstr("frame 0: was encoded as another frame"));
  EXPECT_THAT(error_of([&] { writer.write_encoded(0, "x"); }), HasSubstr("frame 0: damaged at byte 0"));
  writer.write_encoded(0, encode_frame({0, 7, random_labelled(0)}, 25));
  test::expect_same(DatasetReader(folder / "set").read(0), random_labelled(0));
}

TEST(DatasetWriter, RefusesFramesOutOfTurn) {
  test::TemporaryFolder folder;
  DatasetWriter writer(folder / "set", small_info());
  EXPECT_THAT(error_of([&] { writer.write(1, random_labelled(1)); }), HasSubstr("frame 1, expected the first one"));
  writer.write(4, random_labelled(4));
  EXPECT_THAT(error_of([&] { writer.write(6, random_labelled(6)); }), HasSubstr("frame 6, expected 5"));
}

TEST(DatasetWriter, RefusesFoldersThatAreNotItsOwn) {
  const Whole whole;
  EXPECT_THAT(error_of([&] {
                DatasetWriter(whole.path(), {paper_body().toml, "people = 3\n", 7, 10, 4});
              }),
              HasSubstr("another recipe, body, seed or shard size"));
  test::TemporaryFolder folder;
  test::put(folder / "photos/cat.jpg", "meow");
  EXPECT_THAT(error_of([&] { DatasetWriter(folder / "photos", small_info()); }), HasSubstr("other files in it"));
  EXPECT_THAT(error_of([&] { DatasetWriter(folder / "photos/cat.jpg", small_info()); }), HasSubstr("cat.jpg"));
}

TEST(DatasetWriter, LocksItsFolder) {
  test::TemporaryFolder folder;
  const DatasetWriter writer(folder / "set", small_info());
  EXPECT_THAT(error_of([&] { DatasetWriter(folder / "set", small_info()); }), HasSubstr("another process is writing"));
}

TEST(DatasetWriter, RefusesInvalidInfo) {
  test::TemporaryFolder folder;
  EXPECT_THROW(DatasetWriter(folder / "a", small_info(0)), UsageError);
  EXPECT_THROW(DatasetWriter(folder / "a", small_info(10, 0)), UsageError);
  EXPECT_THROW(DatasetWriter(folder / "a", small_info(10, 5000)), UsageError);
  EXPECT_THROW(DatasetWriter(folder / "a", {"no body", "", 1, 10, 4}), Error);
  EXPECT_THAT(error_of([&] {
                DatasetWriter(folder / "a", {paper_body().toml, "\xFF", 1, 10, 4});
              }),
              HasSubstr("not UTF-8"));
}

TEST(DatasetReader, NamesTheFileAndTheFrameOfErrors) {
  const auto complaint = [](const std::function<void(const Whole&)>& harm) {
    const Whole whole;
    harm(whole);
    return error_of([&] {
      const DatasetReader reader(whole.path());
      for (std::uint64_t i = 0; i < reader.size(); ++i) reader.read(i);
    });
  };
  const auto change = [](const std::string& path, std::size_t from_end) {
    std::string bytes = test::get(path);
    bytes[bytes.size() - from_end] ^= 1;
    test::put(path, bytes);
  };
  EXPECT_THAT(complaint([](const Whole& w) { fs::remove(w.shard(1)); }), HasSubstr("000001.shard: missing"));
  EXPECT_THAT(complaint([](const Whole& w) { fs::resize_file(w.shard(2), 500); }), HasSubstr("000002.shard: cut"));
  EXPECT_THAT(complaint([&](const Whole& w) { change(w.shard(2), 5); }), HasSubstr("000002.shard: frame 9: damaged"));
  EXPECT_THAT(complaint([](const Whole& w) { fs::rename(w.shard(0), w.shard(1)); }),
              HasSubstr("000000.shard: missing"));
  EXPECT_THAT(
      complaint([](const Whole& w) { fs::copy_file(w.shard(0), w.shard(1), fs::copy_options::overwrite_existing); }),
      HasSubstr("000001.shard: 4 frames from 0 on, expected 4 from 4 on"));
  EXPECT_THAT(complaint([](const Whole& w) { fs::remove(w.path() + "/dataset.json"); }), HasSubstr("dataset.json"));
  EXPECT_THAT(complaint([](const Whole& w) { test::put(w.path() + "/dataset.json", "{"); }), HasSubstr("JSON object"));
}

TEST(DatasetReader, ChecksItsDescription) {
  const Whole whole;
  const std::string path = whole.path() + "/dataset.json";
  const std::string text = test::get(path);
  const auto complaint = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    test::put(path, changed);
    return error_of([&] { DatasetReader reader(whole.path()); });
  };
  EXPECT_THAT(complaint("\"format\": 3", "\"format\": 4"), HasSubstr("newer version: format 4"));
  EXPECT_THAT(complaint("\"format\": 3", "\"format\": 0"),
              HasSubstr("another version: format 0, this program reads 3"));
  EXPECT_THAT(complaint("\"format\": 3", "\"format\": 1"), HasSubstr("another version: format 1"));
  EXPECT_THAT(complaint("\"joints\"", "\"joint\""), HasSubstr("joints: expected a list of names"));
  EXPECT_THAT(complaint("\"hip\"", "7"), HasSubstr("joints: expected a list of names"));
  EXPECT_THAT(complaint("\"frames\": 10", "\"frames\": -1"), HasSubstr("frames: expected a whole number"));
  EXPECT_THAT(complaint("\"frames\": 10", "\"frames\": 0"), HasSubstr("dataset of 0 frames"));
  EXPECT_THAT(complaint("\"frames\": 10", "\"frames\": 4000000000"), HasSubstr("000002.shard: 2 frames"));
  EXPECT_THAT(complaint("\"seed\": 7", "\"seed\": 8"), HasSubstr("hash does not fit"));
  EXPECT_THAT(complaint("people = 2", "people = 9"), HasSubstr("hash does not fit"));
  EXPECT_THAT(complaint("\"frames_per_shard\": 4", "\"frames_per_shard\": 99999999999"), HasSubstr("frames per shard"));
}

}  // namespace
}  // namespace vesalius
