#include "folders/owned_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/file.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "vesalius/error.h"

namespace vesalius {

FolderLock::FolderLock(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(folder + ": folder cannot be made: " + error.message());
  descriptor_ = Descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor_.is_open()) {
    throw Error(fmt::format("{}: folder cannot be read: {}", folder, std::generic_category().message(errno)));
  }
  if (::flock(descriptor_.get(), LOCK_EX | LOCK_NB) == 0) return;
  const int cause = errno;
  if (cause == EWOULDBLOCK) throw Error(folder + ": another process is writing there");
  throw Error(fmt::format("{}: folder cannot be locked: {}", folder, std::generic_category().message(cause)));
}

TemporaryFolder::TemporaryFolder() {
  folder_ = (std::filesystem::temp_directory_path() / "vesalius-XXXXXX").string();
  if (::mkdtemp(folder_.data()) == nullptr) throw Error(folder_ + ": folder cannot be made");
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace vesalius
