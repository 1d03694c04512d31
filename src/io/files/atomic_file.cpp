#include "io/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw Error(fmt::format("{}: cannot be written: {}", path, std::generic_category().message(error)));
}

/// Writes all and closes; the errno of what failed, 0 = nothing did.
int write_and_close(int fd, std::string_view bytes) {
  int error = 0;
  while (!bytes.empty() && error == 0) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (::close(fd) != 0 && error == 0) error = errno;
  return error;
}

/// A link stays a link: the file that it names is replaced.
std::string behind_links(const std::string& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::canonical(path, error);
  return error ? path : target.string();
}

}  // namespace

bool written_directly(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  const bool inherited = path == "/dev/stdout" || path == "/dev/stderr" || path.starts_with("/dev/fd/");
  return inherited || (fs::exists(status) && !fs::is_regular_file(status));
}

TemporaryFile::TemporaryFile(std::string final_path, const std::string& extension)
    : final_path_(std::move(final_path)) {
  static std::atomic<unsigned> counter{0};
  path_ = fmt::format("{}.tmp{}-{}{}", behind_links(final_path_), ::getpid(), counter++, extension);
}

TemporaryFile::~TemporaryFile() {
  if (!committed_) std::remove(path_.c_str());
}

void TemporaryFile::commit() {
  if (std::rename(path_.c_str(), behind_links(final_path_).c_str()) != 0) fail(final_path_, errno);
  committed_ = true;
}

void write_file_atomically(const std::string& path, std::string_view bytes) {
  if (written_directly(path)) {
    const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd < 0) fail(path, errno);
    if (const int error = write_and_close(fd, bytes)) fail(path, error);
    return;
  }
  TemporaryFile file(path);
  const int fd = ::open(file.path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) fail(path, errno);
  if (const int error = write_and_close(fd, bytes)) fail(path, error);
  file.commit();
}

}  // namespace vesalius
