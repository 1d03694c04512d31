#include "dataset/dataset_shard.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::HasSubstr;

const std::vector<std::string> kFrames = {"first frame", "", std::string(300, 'z')};

ShardTable table_of(const std::string& bytes) {
  return parse_shard_table(bytes.substr(0, kMostShardHeaderBytes), bytes.size(), "a.shard");
}

TEST(Shard, ListsThePlacesOfItsFrames) {
  const std::string bytes = serialise_shard(0x1234, 512, kFrames);
  const ShardTable table = table_of(bytes);
  EXPECT_EQ(table.dataset_hash, 0x1234U);
  EXPECT_EQ(table.first, 512U);
  ASSERT_EQ(table.entries.size(), kFrames.size());
  for (std::size_t i = 0; i < kFrames.size(); ++i) {
    EXPECT_EQ(bytes.substr(table.entries[i].offset, table.entries[i].bytes), kFrames[i]);
    EXPECT_EQ(table.entries[i].checksum, checksum_of(kFrames[i]));
  }
}

TEST(Shard, NoticesEveryFlippedByte) {
  test::TemporaryFolder folder;
  const std::string bytes = serialise_shard(1, 0, kFrames);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(~damaged[at]);
    const std::string path = test::put(folder / "a.shard", damaged);
    EXPECT_NE(error_of([&] {
                const ShardFile file(path);
                const ShardTable table = file.table();
                for (std::size_t i = 0; i < table.entries.size(); ++i) file.frame(table.entries[i], i);
              }),
              "")
        << at;
  }
}

TEST(Shard, NoticesEveryTruncation) {
  const std::string bytes = serialise_shard(1, 0, kFrames);
  EXPECT_THAT(error_of([] { table_of(""); }), HasSubstr("a.shard: cut: 0 bytes"));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THAT(error_of([&] { table_of(bytes.substr(0, size)); }), HasSubstr("cut")) << size;
  }
}

TEST(Shard, NamesTheReasonOfErrors) {
  const std::string bytes = serialise_shard(1, 0, kFrames);
  EXPECT_THAT(error_of([] { table_of("hello there, this is some text of no meaning at all"); }),
              HasSubstr("no shard of a labelled dataset"));
  std::string newer = bytes;
  newer[8] = 4;
  EXPECT_THAT(error_of([&] { table_of(newer); }), HasSubstr("newer version: format 4"));
  EXPECT_THAT(error_of([&] { table_of(bytes + "x"); }), HasSubstr("damaged header"));
  test::TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { ShardFile(folder / "none.shard"); }),
              HasSubstr("none.shard: cannot be read: No such file"));
  EXPECT_THAT(error_of([&] { ShardFile(folder.path()); }), HasSubstr("not a regular file"));
  std::string damaged = bytes;
  damaged.back() = 'y';
  const std::string path = test::put(folder / "b.shard", damaged);
  EXPECT_THAT(error_of([&] { ShardFile(path).frame(table_of(bytes).entries[2], 514); }),
              HasSubstr("b.shard: frame 514: damaged"));
}

}  // namespace
}  // namespace vesalius
