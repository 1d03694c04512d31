#include "io/files/data_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using test::put;
using test::TemporaryFolder;
using testing::HasSubstr;

TEST(ReadFile, ReturnsAllBytes) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\r\n\xFF", 6);
  EXPECT_EQ(read_file(put(folder / "a", bytes)), bytes);
  EXPECT_EQ(read_file(put(folder / "empty", "")), "");
}

TEST(ReadFile, SaysWhyAFileCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { read_file(folder / "none"); }), HasSubstr("none: cannot be read: No such file"));
  EXPECT_THAT(error_of([&] { read_file(folder.path()); }), HasSubstr("not a regular file"));
  const std::string big = put(folder / "big", "12345");
  EXPECT_THAT(error_of([&] { read_file(big, 4); }), HasSubstr("5 bytes, expected at most 4"));
}

TEST(ReadFile, DoesNotWaitForAPipe) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(error_of([&] { read_file(folder / "pipe"); }), HasSubstr("not a regular file"));
}

TEST(ReadFile, RefusesAFileWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const TemporaryFolder folder;
  const std::string path = put(folder / "secret", "x");
  ASSERT_EQ(chmod(path.c_str(), 0), 0);
  EXPECT_THAT(error_of([&] { read_file(path); }), HasSubstr("Permission denied"));
}

}  // namespace
}  // namespace vesalius
