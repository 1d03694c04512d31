#include "io/files/read_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "io/files/descriptor.h"
#include "vesalius/base/error.h"

namespace vesalius {

std::string read_file(const std::string& path, std::size_t max_bytes) {
  const OpenFile file = open_regular_file(path);
  if (file.size > max_bytes) throw Error(fmt::format("{}: {} bytes, expected at most {}", path, file.size, max_bytes));
  std::string bytes(file.size, '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::read(file.descriptor.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(fmt::format("{}: cannot be read: {}", path, std::generic_category().message(errno)));
    if (n == 0) break;
    done += n;
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace vesalius
