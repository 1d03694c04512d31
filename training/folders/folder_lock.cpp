#include "folders/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
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

}  // namespace vesalius
