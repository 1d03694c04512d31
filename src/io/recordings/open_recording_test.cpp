#include "io/recordings/open_recording.h"

#include <gmock/gmock.h>
#include <sqlite3.h>
#include <zstd.h>

#include <ctime>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "io/recordings/chunked_recording.h"
#include "io/recordings/mcap_writer.h"
#include "io/recordings/recording_formats.h"
#include "io/recordings/test_bag.h"

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

TEST(Recording, McapOfAChunkThatEndsInAHeadGoesOn) {
  const test::TemporaryFolder folder;
  ByteWriter chunk;
  for (int i = 0; i < 2; ++i) chunk.number(std::uint64_t{0});  // times
  chunk.number(std::uint64_t{3});
  for (int i = 0; i < 2; ++i) chunk.number(std::uint32_t{0});  // no checksum, not compressed
  chunk.number(std::uint64_t{3});
  chunk.bytes() += "\x05\x01\x01";
  ByteWriter file;
  file.bytes() += "\x89MCAP0\r\n\x06";
  file.number(std::uint64_t{chunk.bytes().size()});
  file.bytes() += chunk.bytes();
  const auto recording = open_recording(test::put(folder / "a.mcap", file.bytes()));
  EXPECT_THAT(error_of([&] { recording->next(); }), HasSubstr("a.mcap"));
  EXPECT_FALSE(recording->next());
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

/// Forty messages of two topics, whose bytes hardly pack, so that a cut leaves some of each kind of packing.
std::vector<Seen> some_messages() {
  std::vector<Seen> messages;
  Random rng(3);
  for (int i = 0; i < 40; ++i) {
    Seen one{i % 3 == 0 ? "/b" : "/a", 1'700'000'000'000'000'000 + std::int64_t{50'000'000} * i,
             std::string(20'000, ' ')};
    for (char& c : one.bytes) c = static_cast<char>(rng.below(256));
    messages.push_back(std::move(one));
  }
  return messages;
}

std::string bag_records_of(const std::vector<Seen>& messages) {
  std::string records =
      test::bag_connection(0, "/a", "std_msgs/String") + test::bag_connection(1, "/b", "std_msgs/String");
  for (const Seen& one : messages)
    records += test::bag_message(one.topic == "/b" ? 1 : 0, static_cast<std::uint64_t>(one.time_ns), one.bytes);
  return records;
}

TEST(Recording, BagCutInItsOnlyChunkGivesTheMessagesBefore) {
  const test::TemporaryFolder folder;
  const std::vector<Seen> written = some_messages();
  for (const char* method : {"none", "bz2", "lz4"}) {
    const std::string bytes = std::string(kBagMagic) + test::bag_chunk(method, bag_records_of(written));
    std::size_t most = 0;
    for (std::size_t size = 20; size < bytes.size(); size += 39'973) {
      test::put(folder / "cut.bag", bytes.substr(0, size));
      const auto recording = open_recording(folder / "cut.bag");
      const std::vector<Seen> seen = all_of(*recording);
      ASSERT_GE(seen.size(), most) << method << " " << size;
      most = seen.size();
      ASSERT_TRUE(std::equal(seen.begin(), seen.end(), written.begin())) << method << " " << size;
      EXPECT_THAT(recording->notes(), ElementsAre(HasSubstr("cut short at byte ")));
      recording->rewind();
      ASSERT_EQ(all_of(*recording), seen);
    }
    // A block of bzip2 is 100 kB here, one of LZ4 64 kB: what lies in a block that is cut is lost.
    EXPECT_GE(most, written.size() - (method == std::string("none") ? 3 : 9)) << method;
  }
}

TEST(Recording, BagThatWasNeverClosedGivesItsLastChunk) {
  const test::TemporaryFolder folder;
  const std::vector<Seen> written = some_messages();
  const std::vector<Seen> before(written.begin(), written.begin() + 10), after(written.begin() + 10, written.end());
  // The chunk at which it was killed: rosbag fills in its sizes when it is full.
  std::string open_chunk =
      test::bag_record({"op=\x05", "compression=none", test::bag_field("size", std::uint32_t{0})}, "");
  open_chunk += bag_records_of(after);
  test::put(folder / "a.bag", std::string(kBagMagic) + test::bag_chunk("none", bag_records_of(before)) +
                                  open_chunk.substr(0, open_chunk.size() - 5));
  const auto recording = open_recording(folder / "a.bag");
  const std::vector<Seen> seen = all_of(*recording);
  EXPECT_EQ(seen, std::vector<Seen>(written.begin(), written.end() - 1));
  EXPECT_EQ(recording->topics()[0].messages + recording->topics()[1].messages, 39);
  EXPECT_EQ(recording->last_ns(), seen.back().time_ns);
}

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;

Database make_database(const std::string& path, const std::string& sql) {
  sqlite3* opened = nullptr;
  sqlite3_open(path.c_str(), &opened);
  char* why = nullptr;
  EXPECT_EQ(sqlite3_exec(opened, sql.c_str(), nullptr, nullptr, &why), SQLITE_OK) << why;
  return {opened, sqlite3_close};
}

/// As rosbag2 has them.
const std::string kTopics =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT "
    "NULL, offered_qos_profiles TEXT NOT NULL);"
    "INSERT INTO topics VALUES(1, '/a', 'std_msgs/msg/String', 'cdr', '');";
const std::string kMessages =
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB "
    "NOT "
    "NULL);";
const std::string kTimeIndex = "CREATE INDEX timestamp_idx ON messages (timestamp ASC);";

TEST(Recording, SqliteIsReadWithTheLogThatAKilledWriterLeft) {
  const test::TemporaryFolder folder;
  const Database writer = make_database(
      folder / "a.db3", "PRAGMA journal_mode=WAL;" + kTopics + kMessages + kTimeIndex +
                            "INSERT INTO messages VALUES(1, 1, 10, x'01');PRAGMA wal_checkpoint(TRUNCATE);"
                            "INSERT INTO messages VALUES(2, 1, 20, x'02');");
  std::filesystem::create_directory(folder / "left");
  for (const char* name : {"a.db3", "a.db3-wal"})
    std::filesystem::copy_file(folder / name, folder / (std::string("left/") + name));
  const std::string before = test::get(folder / "left/a.db3"), log = test::get(folder / "left/a.db3-wal");
  {
    const auto recording = open_recording(folder / "left/a.db3");
    EXPECT_EQ(all_of(*recording), (std::vector<Seen>{{"/a", 10, "\x01"}, {"/a", 20, "\x02"}}));
    EXPECT_EQ(recording->topics()[0].messages, 2);
    EXPECT_THAT(recording->notes(), ElementsAre(HasSubstr("a.db3-wal are read too")));
  }
  EXPECT_EQ(test::get(folder / "left/a.db3"), before) << "nothing is written to what people bring";
  EXPECT_EQ(test::get(folder / "left/a.db3-wal"), log);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "left"), {}), 2);
  std::filesystem::remove(folder / "left/a.db3-wal");
  EXPECT_EQ(all_of(*open_recording(folder / "left/a.db3")).size(), 1U);
}

TEST(Recording, SqliteWithoutAnIndexComesInTheOrderOfTime) {
  const test::TemporaryFolder folder;
  make_database(
      folder / "a.db3",
      kTopics + kMessages + "INSERT INTO messages VALUES(1, 1, 30, x'03'),(2, 1, 10, x'01'),(3, 1, 20, x'02');");
  const auto recording = open_recording(folder / "a.db3");
  EXPECT_EQ(all_of(*recording), (std::vector<Seen>{{"/a", 10, "\x01"}, {"/a", 20, "\x02"}, {"/a", 30, "\x03"}}));
  expect_seeks(*recording);
}

/// Expects a file to be refused soon, with these words.
void expect_refused(const std::string& path, const char* why) {
  const std::clock_t start = std::clock();
  EXPECT_THAT(error_of([&] { all_of(*open_recording(path)); }), AllOf(HasSubstr(path), HasSubstr(why)));
  EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 10.0);
}

TEST(Recording, SqliteOfWorkedOutColumnsOrViewsIsRefused) {
  const test::TemporaryFolder folder;
  make_database(folder / "column.db3",
                "CREATE TABLE topics(id INTEGER PRIMARY KEY, type TEXT, serialization_format TEXT, name TEXT AS "
                "(hex(hex(zeroblob(100000000)))));INSERT INTO topics(id, type) VALUES(1, 'a'),(2, 'b');" +
                    kMessages);
  expect_refused(folder / "column.db3", "table topics has generated columns");
  make_database(folder / "view.db3",
                kTopics +
                    "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + "
                    "1 FROM n) SELECT i AS id, 1 AS topic_id, i AS timestamp, x'00' AS data FROM n;");
  expect_refused(folder / "view.db3", "no ROS 2 bag, expected tables");
}

/// Makes the table `messages` of a database pages of `cells` cells that all lead to the next page, `levels` of them.
void make_ladder(const std::string& path, int levels, int cells) {
  constexpr std::size_t kPage = 4096;
  make_database(path, "PRAGMA page_size=4096;" + kTopics + kMessages + "INSERT INTO messages VALUES(1, 1, 1, x'00');");
  std::string bytes = test::get(path);
  const auto page_count = bytes.size() / kPage;
  std::string leaf = bytes.substr(2 * kPage, kPage);
  ASSERT_EQ(leaf[0], 13) << "a leaf of a table";
  for (int level = 0; level < levels; ++level) {
    std::string page(kPage, '\0');
    const auto put = [&](std::size_t at, std::size_t value, int count) {
      for (int i = 0; i < count; ++i)
        page[at + static_cast<std::size_t>(i)] = static_cast<char>(value >> (8 * (count - 1 - i)));
    };
    const std::size_t next = page_count + static_cast<std::size_t>(level) + 1;
    page[0] = 5;  // an inner page of a table
    put(3, static_cast<std::size_t>(cells), 2);
    const std::size_t cell = kPage - 5;
    put(5, cell, 2);
    put(8, next, 4);
    put(cell, next, 4);
    page[cell + 4] = 1;  // key
    for (int i = 0; i < cells; ++i) put(12 + 2 * static_cast<std::size_t>(i), cell, 2);
    if (level == 0) {
      bytes.replace(2 * kPage, kPage, page);
    } else {
      bytes += page;
    }
  }
  bytes += leaf;
  const std::size_t pages = bytes.size() / kPage;
  for (std::size_t i = 0; i < 4; ++i) bytes[28 + i] = static_cast<char>(pages >> (8 * (3 - i)));
  test::put(path, bytes);
}

TEST(Recording, SqliteWithMoreRowsThanItHasRoomForIsRefused) {
  const test::TemporaryFolder folder;
  make_ladder(folder / "ladder.db3", 5, 400);
  expect_refused(folder / "ladder.db3", "more rows than its size can hold");
}

TEST(Recording, PackedAsAWholeIsRead) {
  const test::TemporaryFolder folder;
  const std::vector<Seen> written = write_some(folder / "a.mcap", true);
  make_database(folder / "a.db3", kTopics + kMessages + "INSERT INTO messages VALUES(1, 1, 10, x'01');");
  const auto pack_file = [&](const std::string& name) {
    const std::string bytes = test::get(folder / name);
    std::string packed(ZSTD_compressBound(bytes.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
    return test::put(folder / (name + ".zstd"), packed);
  };
  EXPECT_EQ(all_of(*open_recording(pack_file("a.mcap"))), written);
  EXPECT_EQ(all_of(*open_recording(pack_file("a.db3"))), (std::vector<Seen>{{"/a", 10, "\x01"}}));
  test::put(folder / "text", "no recording at all");
  EXPECT_THAT(error_of([&] { open_recording(pack_file("text")); }),
              AllOf(HasSubstr("text.zstd: no recording that is known")));
  std::string damaged = test::get(folder / "a.mcap.zstd");
  damaged[12] ^= 0x55;
  damaged[13] ^= 0x55;
  EXPECT_THAT(error_of([&] { open_recording(test::put(folder / "b.zstd", damaged)); }), HasSubstr("b.zstd"));
}

TEST(Recording, ThatUnpacksToFarMoreThanItIsIsRefusedSoon) {
  const test::TemporaryFolder folder;
  // One record of a kind that nobody knows.
  ByteWriter record;
  record.number(std::uint8_t{0x80});
  record.number(std::uint64_t{kMaxPieceBytes - 9});
  const std::string zeros = record.bytes() + std::string(kMaxPieceBytes - 9, '\0');
  std::string packed(ZSTD_compressBound(zeros.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), zeros.data(), zeros.size(), 1));
  ByteWriter chunk;
  for (int i = 0; i < 2; ++i) chunk.number(std::uint64_t{0});  // times
  chunk.number(static_cast<std::uint64_t>(zeros.size()));
  chunk.number(std::uint32_t{0});
  chunk.text("zstd");
  chunk.number(static_cast<std::uint64_t>(packed.size()));
  chunk.bytes() += packed;
  std::string bytes(kMcapMagic);
  for (int i = 0; i < 100; ++i) {
    ByteWriter head;
    head.number(static_cast<std::uint8_t>(McapRecord::chunk));
    head.number(static_cast<std::uint64_t>(chunk.bytes().size()));
    bytes += head.bytes() + chunk.bytes();
  }
  expect_refused(test::put(folder / "a.mcap", bytes), "unpacks to more than");
  std::string many;
  for (int i = 0; i < 100; ++i) many += packed;
  expect_refused(test::put(folder / "a.mcap.zstd", many), "unpacks to more than");
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
