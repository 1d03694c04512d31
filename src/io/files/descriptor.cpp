#include "io/files/descriptor.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "vesalius/error.h"

namespace vesalius {

int Descriptor::close() {
  if (fd_ < 0) return 0;
  return ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno;
}

OpenFile open_regular_file(const std::string& path) {
  const auto fail = [&](int error) {
    throw Error(fmt::format("{}: cannot be read: {}", path, std::generic_category().message(error)));
  };
  // O_NONBLOCK is needed because opening a pipe that nobody writes to would wait for ever.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  struct stat info {};
  if (!file.is_open() || ::fstat(file.get(), &info) != 0) fail(errno);
  if (!S_ISREG(info.st_mode)) throw Error(path + ": not a regular file");
  return {std::move(file), static_cast<std::uint64_t>(info.st_size)};
}

int write_all(const Descriptor& descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor.get(), bytes.data(), bytes.size());
    if (n < 0 && errno != EINTR) return errno;
    if (n > 0) bytes.remove_prefix(n);
  }
  return 0;
}

}  // namespace vesalius
