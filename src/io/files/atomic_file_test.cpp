#include "io/files/atomic_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::get;
using test::put;
using test::TemporaryFolder;
using testing::HasSubstr;

TEST(WriteFileAtomically, ReplacesTheWholeFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const std::string path = put(folder / "a.txt", "something rather long");
  write_file_atomically(path, std::string_view("new\0bytes", 9));
  EXPECT_EQ(get(path), std::string("new\0bytes", 9));
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(WriteFileAtomically, NamesThePathAndTheReason) {
  const TemporaryFolder folder;
  const std::string path = folder / "none/a.txt";
  EXPECT_THAT(error_of([&] { write_file_atomically(path, "x"); }), HasSubstr(path + ": cannot be written: No such"));
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(WriteFileAtomically, ThrowsOnAFullDevice) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THAT(error_of([] { write_file_atomically("/dev/full", "x"); }),
              HasSubstr("/dev/full: cannot be written: No space"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(WriteFileAtomically, KeepsTheOldFileWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  const std::string path = put(folder / "a.bin", "old");
  // A limit on file sizes makes a write fail in the middle, as a full disk does.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  const std::string message = error_of([&] { write_file_atomically(path, std::string(5000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(message, HasSubstr("File too large"));
  EXPECT_EQ(get(path), "old");
  EXPECT_EQ(folder.file_count(), 1U);
}

TEST(WriteFileAtomically, ReplacesTheFileBehindALink) {
  const TemporaryFolder folder;
  const std::string target = put(folder / "target.txt", "old");
  fs::create_symlink(target, folder / "link.txt");
  write_file_atomically(folder / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(get(target), "new");
}

TEST(WriteFileAtomically, RefusesAFolder) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { write_file_atomically(folder.path(), "x"); }), HasSubstr(folder.path() + ": cannot be"));
}

TEST(CheckWritable, SaysWhatWritingWouldAndLeavesNothing) {
  const TemporaryFolder folder;
  const std::string there = put(folder / "a.txt", "old");
  check_writable(there);
  check_writable(folder / "b.txt");
  check_writable("/dev/null");
  EXPECT_EQ(get(there), "old");
  EXPECT_EQ(folder.file_count(), 1U);
  for (const std::string& path : {folder / "none/a.txt", folder.path(), folder / "a.txt/b.txt"}) {
    const std::string expected = error_of([&] { write_file_atomically(path, "x"); });
    EXPECT_THAT(expected, HasSubstr(path + ": cannot be written: "));
    EXPECT_EQ(error_of([&] { check_writable(path); }), expected);
  }
}

TEST(CheckWritable, DoesNotWaitForTheReaderOfAPipe) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  check_writable(pipe);
}

TEST(TemporaryFile, IsRemovedUnlessCommitted) {
  const TemporaryFolder folder;
  {
    const TemporaryFile file(folder / "a.avi", ".avi");
    EXPECT_TRUE(file.path().ends_with(".avi"));
    put(file.path(), "half");
  }
  EXPECT_EQ(folder.file_count(), 0U);
  {
    TemporaryFile file(folder / "a.avi", ".avi");
    put(file.path(), "whole");
    file.commit();
  }
  EXPECT_EQ(get(folder / "a.avi"), "whole");
}

/// Returns the number of a process that has ended.
pid_t gone() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

TEST(TemporaryFile, RemovesLeftoversOfKilledProcesses) {
  const TemporaryFolder folder;
  const std::string dead = std::to_string(gone());
  const std::string left = put(folder / ("a.txt.tmp" + dead + "-3"), "half");
  const std::string left_video = put(folder / ("a.txt.tmp" + dead + "-12.avi"), "half");
  const std::vector<std::string> others = {
      put(folder / ("b.txt.tmp" + dead + "-3"), "of another name"),
      put(folder / ("a.txt.tmp" + std::to_string(getppid()) + "-0"), "of a process that lives"),
      put(folder / ("a.txt.tmp" + dead), "not our pattern"),
      put(folder / "a.txt.tmpfile-1", "not our pattern"),
      put(folder / "a.txt.tmp", "not our pattern"),
  };
  write_file_atomically(folder / "a.txt", "whole");
  EXPECT_FALSE(fs::exists(left));
  EXPECT_FALSE(fs::exists(left_video));
  for (const std::string& other : others) EXPECT_TRUE(fs::exists(other)) << other;
  write_file_atomically(folder / "b.txt", "whole");
  EXPECT_FALSE(fs::exists(others[0]));
}

TEST(TemporaryFile, KeepsFilesThatAnotherContainerIsWriting) {
  const TemporaryFolder folder;
  const std::string path = put(folder / ("a.txt.tmp" + std::to_string(gone()) + "-3"), "half");
  const Descriptor writer(open(path.c_str(), O_RDONLY));
  ASSERT_EQ(flock(writer.get(), LOCK_EX), 0);
  write_file_atomically(folder / "a.txt", "whole");
  EXPECT_TRUE(fs::exists(path)) << "its writer has another number there, but its lock is seen";
}

}  // namespace
}  // namespace vesalius
