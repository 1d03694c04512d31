#include "io/files/data_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "vesalius/error.h"

namespace vesalius {

DataFile::DataFile(const std::string& path) : path_(path), file_(open_regular_file(path)) {}

std::string DataFile::read(std::uint64_t at, std::uint64_t count) const {
  if (at >= size()) return {};
  std::string bytes(std::min(count, size() - at), '\0');
  bytes.resize(read_into(at, std::as_writable_bytes(std::span(bytes))));
  return bytes;
}

std::size_t DataFile::read_into(std::uint64_t at, std::span<std::byte> memory) const {
  std::size_t done = 0;
  while (done < memory.size()) {
    const ssize_t n =
        ::pread(file_.descriptor.get(), memory.data() + done, memory.size() - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(fmt::format("{}: cannot be read: {}", path_, std::generic_category().message(errno)));
    if (n == 0) break;
    done += n;
  }
  return done;
}

std::string read_file(const std::string& path, std::size_t max_bytes) {
  const DataFile file(path);
  if (file.size() > max_bytes) {
    throw Error(fmt::format("{}: {} bytes, expected at most {}", path, file.size(), max_bytes));
  }
  return file.read(0, file.size());
}

}  // namespace vesalius
