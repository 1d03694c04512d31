#include "downloads/verified_file.h"

#include <sys/resource.h>

#include <csignal>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

FileDigest digest_of(std::string_view bytes) { return {bytes.size(), sha256_of(bytes)}; }

TEST(VerifiedFile, AppearsOnlyWhenComplete) {
  const test::TemporaryFolder folder;
  VerifiedFile file(folder / "a/b/final", folder / "part", digest_of("hello world"));
  file.write("wrong");
  file.restart();
  file.write("hello ");
  file.write("world");
  EXPECT_FALSE(fs::exists(folder / "a"));
  file.commit();
  EXPECT_EQ(test::get(folder / "a/b/final"), "hello world");
  EXPECT_FALSE(fs::exists(folder / "part"));
  EXPECT_TRUE(holds(folder / "a/b/final", digest_of("hello world")));
  EXPECT_FALSE(holds(folder / "a/b/final", digest_of("hello World")));
  EXPECT_FALSE(holds(folder / "a/b/final", digest_of("hello")));
  EXPECT_FALSE(holds(folder / "a/b", digest_of("")));
  EXPECT_FALSE(holds(folder / "none", digest_of("")));
}

TEST(VerifiedFile, RefusesOtherBytesAndKeepsTheOldFile) {
  const test::TemporaryFolder folder;
  const std::string path = test::put(folder / "f", "old");
  const auto write = [&](std::string_view bytes) {
    VerifiedFile file(path, folder / "part", digest_of("abc"));
    file.write(bytes);
    file.commit();
  };
  EXPECT_THAT(test::error_of([&] { write("abcd"); }), HasSubstr("/f: more bytes came than the 3 expected"));
  EXPECT_THAT(test::error_of([&] { write("ab"); }), HasSubstr("/f: 2 bytes came, expected 3"));
  EXPECT_THAT(test::error_of([&] { write("abd"); }), HasSubstr("expected ba7816bf"));
  EXPECT_THROW(write("abd"), WrongBytes);
  EXPECT_EQ(test::get(path), "old");
  EXPECT_EQ(folder.file_count(), 1U);
  write("abc");
  EXPECT_EQ(test::get(path), "abc");
}

TEST(VerifiedFile, NamesTheReasonIfItCannotBeWritten) {
  const test::TemporaryFolder folder;
  test::put(folder / "file", "");
  EXPECT_THAT(test::error_of([&] { VerifiedFile(folder / "f", folder / "none/part", digest_of("abc")); }),
              HasSubstr("/f: cannot be written: No such file"));
  const auto below_a_file = [&] {
    VerifiedFile file(folder / "file/f", folder / "part", digest_of(""));
    file.commit();
  };
  EXPECT_THAT(test::error_of(below_a_file), HasSubstr("file/f: cannot be written: "));
  EXPECT_EQ(folder.file_count(), 1U);
}

// A limit on the size of files stands in for a full disk, since both make a write fail with a reason.
TEST(VerifiedFile, ReportsAFullDisk) {
  const test::TemporaryFolder folder;
  const std::string bytes(1 << 16, 'x');
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  std::string message;
  {
    VerifiedFile file(folder / "f", folder / "part", digest_of(bytes));
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    message = test::error_of([&] { file.write(bytes); });
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  }
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message, HasSubstr("/f: cannot be written: File too large"));
  EXPECT_EQ(folder.file_count(), 0U);
}

}  // namespace
}  // namespace vesalius
