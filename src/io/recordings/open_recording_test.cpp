#include "io/recordings/open_recording.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "io/recordings/mcap_writer.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::AllOf;

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Seen {
  std::string topic;
  std::int64_t time_ns;
  std::string bytes;
  friend bool operator==(const Seen&, const Seen&) = default;
};

std::vector<Seen> all_of(Recording& recording) {
  std::vector<Seen> seen;
  while (const auto message = recording.next()) {
    seen.push_back({recording.topics()[message->topic].name, message->time_ns, std::string(message->bytes)});
  }
  return seen;
}

/// Messages of two topics, two seconds of them and so at least two chunks.
std::vector<Seen> write_some(const std::string& path, bool close) {
  std::vector<Seen> written;
  McapWriter out(path);
  const auto a = out.add_topic("/a", "std_msgs/msg/String", "string data\n");
  const auto b = out.add_topic("/b", "std_msgs/msg/String", "string data\n");
  for (int i = 0; i < 40; ++i) {
    const Seen one{i % 3 == 0 ? "/b" : "/a", std::int64_t{50'000'000} * i,
                   std::string(static_cast<std::size_t>(i), 'x')};
    out.write(i % 3 == 0 ? b : a, one.time_ns, one.bytes);
    written.push_back(one);
  }
  if (!close) {
    // As a process leaves it that was killed.
    std::filesystem::copy_file(path, path + ".killed");
  }
  out.close();
  return written;
}

TEST(Recording, McapGivesBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  const std::vector<Seen> written = write_some(folder / "a.mcap", true);
  const auto recording = open_recording(folder / "a.mcap");
  ASSERT_EQ(recording->topics().size(), 2U);
  EXPECT_EQ(recording->topics()[0].type, "std_msgs/String");
  EXPECT_EQ(recording->topics()[0].messages, 26);
  EXPECT_EQ(recording->topics()[1].messages, 14);
  EXPECT_EQ(all_of(*recording), written);
  EXPECT_THAT(recording->notes(), IsEmpty());
  recording->rewind();
  EXPECT_EQ(all_of(*recording), written);
}

TEST(Recording, McapOfAKilledProcessLacksOneSecondAtMost) {
  const test::TemporaryFolder folder;
  std::vector<Seen> written = write_some(folder / "a.mcap", false);
  const auto recording = open_recording(folder / "a.mcap.killed");
  const std::vector<Seen> seen = all_of(*recording);
  ASSERT_GE(seen.size(), written.size() - 20);
  ASSERT_LT(seen.size(), written.size());
  written.resize(seen.size());
  EXPECT_EQ(seen, written);
  EXPECT_EQ(recording->topics()[0].messages + recording->topics()[1].messages, std::ssize(seen));
  EXPECT_THAT(recording->notes(), ElementsAre(HasSubstr("cut short at byte ")));
}

TEST(Recording, McapCutAnywhereGivesTheMessagesBefore) {
  const test::TemporaryFolder folder;
  const std::vector<Seen> written = write_some(folder / "a.mcap", true);
  const std::string bytes = test::get(folder / "a.mcap");
  std::size_t most = 0;
  for (std::size_t size = 8; size < bytes.size(); size += 7) {
    test::put(folder / "cut.mcap", bytes.substr(0, size));
    const std::vector<Seen> seen = all_of(*open_recording(folder / "cut.mcap"));
    ASSERT_GE(seen.size(), most) << size;
    most = seen.size();
    ASSERT_TRUE(std::equal(seen.begin(), seen.end(), written.begin())) << size;
  }
  EXPECT_EQ(most, written.size());
}

/// Everything recorded at a time or later comes after a seek, in the same order; earlier things come only before it.
void expect_seeks(Recording& recording) {
  recording.rewind();
  const std::vector<Seen> all = all_of(recording);
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(recording.last_ns(), std::ranges::max_element(all, {}, &Seen::time_ns)->time_ns);
  for (const Seen& to : all) {
    for (const std::int64_t time_ns : {to.time_ns, to.time_ns + 1}) {
      const bool left_out = recording.seek(time_ns);
      const std::vector<Seen> rest = all_of(recording);
      ASSERT_LE(rest.size(), all.size());
      EXPECT_EQ(left_out, rest.size() < all.size()) << time_ns;
      const auto missing = all.end() - std::ssize(rest);
      ASSERT_TRUE(std::equal(missing, all.end(), rest.begin())) << time_ns;
      for (auto one = all.begin(); one != missing; ++one) ASSERT_LT(one->time_ns, time_ns);
    }
  }
}

TEST(Recording, McapSeeksByItsIndexAndWithoutOne) {
  const test::TemporaryFolder folder;
  write_some(folder / "a.mcap", true);
  const std::string bytes = test::get(folder / "a.mcap");
  test::put(folder / "cut.mcap", bytes.substr(0, bytes.size() - 20));
  for (const char* name : {"a.mcap", "cut.mcap"}) {
    const auto recording = open_recording(folder / name);
    expect_seeks(*recording);
    const std::int64_t last_ns = *recording->last_ns();
    EXPECT_TRUE(recording->seek(last_ns)) << name;
    EXPECT_GT(recording->next()->time_ns, 0) << name;
    EXPECT_FALSE(recording->seek(0)) << name;
    EXPECT_EQ(recording->next()->time_ns, 0) << name;
  }
}

TEST(Recording, SeekDoesNotReadTheChunksBefore) {
  const test::TemporaryFolder folder;
  write_some(folder / "a.mcap", true);
  std::string bytes = test::get(folder / "a.mcap");
  const std::size_t packed = bytes.find("\x28\xB5\x2F\xFD");
  ASSERT_NE(packed, bytes.npos);
  bytes[packed + 8] ^= 0x55;
  test::put(folder / "damaged.mcap", bytes);
  const auto recording = open_recording(folder / "damaged.mcap");
  EXPECT_THAT(error_of([&] { all_of(*recording); }), HasSubstr("damaged"));
  recording->seek(1'500'000'000);
  EXPECT_GE(all_of(*recording).size(), 10U);
}

TEST(Recording, RefusesWhatIsNone) {
  const test::TemporaryFolder folder;
  test::put(folder / "empty.bag", "");
  EXPECT_THAT(error_of([&] { open_recording(folder / "empty.bag"); }),
              AllOf(HasSubstr("empty.bag"), HasSubstr("empty"), HasSubstr("expected MCAP")));
  test::put(folder / "text.mcap", "some text that is long enough");
  EXPECT_THAT(error_of([&] { open_recording(folder / "text.mcap"); }),
              AllOf(HasSubstr("text.mcap"), HasSubstr("no recording that is known")));
  test::put(folder / "a.db3", "SQLite format 3 but no more");
  EXPECT_THAT(error_of([&] { open_recording(folder / "a.db3"); }),
              AllOf(HasSubstr("a.db3"), HasSubstr("not a ROS 2 bag")));
}

TEST(Recording, IsNotWrittenOverAnotherFile) {
  const test::TemporaryFolder folder;
  test::put(folder / "a.mcap", "mine");
  EXPECT_THAT(error_of([&] { McapWriter(folder / "a.mcap"); }),
              AllOf(HasSubstr("a.mcap"), HasSubstr("cannot be created"), HasSubstr("exists")));
  EXPECT_EQ(test::get(folder / "a.mcap"), "mine");
}

/// Written by the tools of others (tests/recordings/other_side.py --fixtures).
class RecordingsOfOthers : public testing::TestWithParam<const char*> {};

TEST_P(RecordingsOfOthers, Seek) {
  expect_seeks(*open_recording(std::string(VESALIUS_FUZZ_SEEDS) + "/fuzz_recording/" + GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Fixtures, RecordingsOfOthers,
                         testing::Values("plain.bag", "bz2.bag", "lz4.bag", "plain.db3", "zstd.db3", "zstd.mcap",
                                         "lz4.mcap", "loose.mcap", "foxglove.mcap"));

}  // namespace
}  // namespace vesalius
