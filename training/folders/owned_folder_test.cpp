#include "folders/owned_folder.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

TEST(FolderLock, AdmitsOneHolderAtATime) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "a/b";
  {
    const FolderLock first(path);
    EXPECT_TRUE(std::filesystem::is_directory(path));
    EXPECT_THAT(test::error_of([&] { FolderLock second(path); }), HasSubstr("b: another process is writing there"));
  }
  EXPECT_NO_THROW(FolderLock third(path));
}

TEST(FolderLock, RefusesAFile) {
  const test::TemporaryFolder folder;
  test::put(folder / "file", "x");
  EXPECT_THAT(test::error_of([&] { FolderLock lock(folder / "file"); }), HasSubstr("file: folder cannot be"));
}

}  // namespace
}  // namespace vesalius
