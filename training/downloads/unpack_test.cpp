#include "downloads/unpack.h"

#include <map>

#include "downloads/test_archive.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::ArchiveEntry;
using test::write_archive;
using testing::HasSubstr;

using Files = std::map<std::string, std::string>;

Files unpacked(const std::string& archive, const std::string& unwanted = "") {
  Files files;
  std::string current;
  unpack(archive, {[&](const std::string& path) {
                     current = path;
                     if (path != unwanted) files[path];
                     return path != unwanted;
                   },
                   [&](std::string_view bytes) { files[current] += bytes; }, [&] { files[current] += "|"; }});
  return files;
}

TEST(Unpack, GivesTheWantedFiles) {
  const test::TemporaryFolder folder;
  std::string large;
  for (int i = 0; i < 300'000; ++i) large += static_cast<char>(i % 1000 * (i % 251));
  const std::vector<ArchiveEntry> entries = {
      {"p/", "", AE_IFDIR}, {"p/a.txt", "one"}, {"p/sub/large", large}, {"./p/empty", ""}, {"p/skip", "no"}};
  const Files expected = {{"p/a.txt", "one|"}, {"p/sub/large", large + "|"}, {"p/empty", "|"}};
  for (const char* name : {"a.tar", "a.tar.xz", "a.tar.gz"}) {
    EXPECT_EQ(unpacked(write_archive(folder / name, entries), "p/skip"), expected) << name;
  }
}

TEST(Unpack, RefusesPathsThatLeadOutside) {
  const test::TemporaryFolder folder;
  for (const char* path : {"/etc/passwd", "../up", "p/../../up", "p//q", "p/./q", "..", "p\\q", "p\nq"}) {
    const std::string archive = write_archive(folder / "bad.tar", {{path, "x"}});
    EXPECT_THAT(test::error_of([&] { unpacked(archive); }), HasSubstr("expected a path inside the archive")) << path;
  }
  for (const ArchiveEntry& entry :
       {ArchiveEntry{"p/link", "/etc", AE_IFLNK}, ArchiveEntry{"p/pipe", "", AE_IFIFO},
        ArchiveEntry{"p/dev", "", AE_IFCHR}, ArchiveEntry{"p/hard", "p/a", test::kHardLink}}) {
    const std::string archive = write_archive(folder / "bad.tar", {{"p/a", "x"}, entry});
    EXPECT_THAT(test::error_of([&] { unpacked(archive); }), HasSubstr("is a link or device")) << entry.path;
  }
}

TEST(Unpack, RefusesDamagedArchives) {
  const test::TemporaryFolder folder;
  const std::string whole = test::get(write_archive(folder / "a.tar.xz", {{"p/a", std::string(100'000, 'x')}}));
  const auto error = [&](const std::string& bytes) {
    const std::string path = test::put(folder / "cut.tar.xz", bytes);
    return test::error_of([&] { unpacked(path); });
  };
  EXPECT_THAT(error(whole.substr(0, whole.size() / 2)), HasSubstr("cut.tar.xz: cannot be unpacked: "));
  std::string flipped = whole;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x55);
  EXPECT_THAT(error(flipped), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(error("no archive at all, but long enough to be looked at"), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(test::error_of([&] { unpacked(folder / "none"); }), HasSubstr("cannot be unpacked"));
}

TEST(StaysInside, HoldsOnlyForPathsBelowTheFolder) {
  for (const char* good : {"a", "a/b", ".part", "a..b/c", "..a", "a b"}) EXPECT_TRUE(stays_inside(good)) << good;
  for (const char* bad : {"", "/", "/a", "a/", "a//b", ".", "./a", "a/.", "..", "../a", "a/..", "a/../b", "a\tb"}) {
    EXPECT_FALSE(stays_inside(bad)) << bad;
  }
}

}  // namespace
}  // namespace vesalius
