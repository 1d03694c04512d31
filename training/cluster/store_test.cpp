#include "cluster/store.h"

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string bytes_of(std::size_t count, std::uint64_t seed) {
  Random rng(seed);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(rng.next() & 0xFFU);
  return bytes;
}

TEST(FolderStore, ReadsWhatWasWritten) {
  const test::TemporaryFolder folder;
  const std::unique_ptr<Store> store = open_store(folder / "not/there yet");
  const std::string bytes = bytes_of(100000, 1);
  store->write("a/b/c.bin", bytes);
  EXPECT_EQ(store->read("a/b/c.bin"), bytes);
  const HugeBuffer loaded = store->load("a/b/c.bin");
  EXPECT_EQ(std::string_view(reinterpret_cast<const char*>(loaded.data()), loaded.size()), bytes);
  EXPECT_TRUE(store->exists("a/b/c.bin"));
  EXPECT_TRUE(store->exists("a/b"));
  EXPECT_FALSE(store->exists("a/c"));
  EXPECT_FALSE(store->exists("a/b/c.bin/d"));
  store->write("a/b/c.bin", "");
  EXPECT_EQ(store->read("a/b/c.bin"), "");
}

TEST(FolderStore, ListsAFolderInOrder) {
  const test::TemporaryFolder folder;
  const std::unique_ptr<Store> store = open_store(folder.path());
  for (const char* name : {"x/10", "x/9", "x/below/1", "y"}) store->write(name, "bytes");
  test::put(folder / "x/9.tmp123-4", "half");
  EXPECT_THAT(store->list("x"), ElementsAre("10", "9", "below"));
  EXPECT_THAT(store->list(""), ElementsAre("x", "y"));
  EXPECT_THAT(store->list("none"), IsEmpty());
  EXPECT_THAT(store->list("y"), IsEmpty());
  EXPECT_THAT(store->list("y/below"), IsEmpty());
  EXPECT_THAT(open_store(folder / "none")->list(""), IsEmpty());
}

TEST(FolderStore, RemovesFilesAndFolders) {
  const test::TemporaryFolder folder;
  const std::unique_ptr<Store> store = open_store(folder.path());
  for (const char* name : {"x/1", "x/below/2", "y"}) store->write(name, "bytes");
  store->remove("x/1");
  EXPECT_THAT(store->list("x"), ElementsAre("below"));
  store->remove("x");
  EXPECT_THAT(store->list(""), ElementsAre("y"));
  store->remove("x");
  store->remove("y/below");
  EXPECT_THAT(store->list(""), ElementsAre("y"));
}

TEST(FolderStore, NamesTheFileThatFails) {
  const test::TemporaryFolder folder;
  const std::unique_ptr<Store> store = open_store(folder.path());
  store->write("x", "bytes");
  EXPECT_THAT(test::error_of([&] { store->read("none"); }), HasSubstr(folder / "none"));
  EXPECT_THAT(test::error_of([&] { store->write("x/y", "bytes"); }), HasSubstr(folder / "x/y"));
  test::put(folder / "z/file", "");
  EXPECT_THAT(test::error_of([&] { store->write("z", "bytes"); }), HasSubstr(folder / "z"));
  EXPECT_EQ(folder.file_count(), 3U);
}

TEST(FolderStore, RefusesNamesThatLeadElsewhere) {
  const test::TemporaryFolder folder;
  const std::unique_ptr<Store> store = open_store(folder / "store");
  for (const char* name : {"", "/x", "../x", "x/../y", "x/./y", "x//y", "x/", "a b", "x?", "x%41", "x.tmp1", "\n"}) {
    EXPECT_THROW(store->read(name), UsageError) << name;
    EXPECT_THROW(store->load(name), UsageError) << name;
    EXPECT_THROW(store->exists(name), UsageError) << name;
    EXPECT_THROW(store->write(name, "bytes"), UsageError) << name;
    EXPECT_THROW(store->remove(name), UsageError) << name;
    if (*name != '\0') {
      EXPECT_THROW(store->list(name), UsageError) << name;
    }
  }
  EXPECT_EQ(folder.file_count(), 0U);
  store->write("..x/a_B-3..", "bytes");
  EXPECT_EQ(store->read("..x/a_B-3.."), "bytes");
}

TEST(OpenStore, TakesAFolder) {
  const test::TemporaryFolder folder;
  const auto store = open_store((folder / "x") + "/");
  EXPECT_EQ(store->place(), folder / "x");
  EXPECT_TRUE(open_store("relative")->place().starts_with('/'));
}

TEST(OpenStore, RefusesOtherPlaces) {
  EXPECT_THROW(open_store("ftp://x"), UsageError);
  EXPECT_THROW(open_store(""), UsageError);
  EXPECT_THAT(test::error_of([] { open_store("ftp://x"); }), HasSubstr("webhdfs://HOST:PORT/PATH"));
}

}  // namespace
}  // namespace vesalius
