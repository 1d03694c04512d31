#include "io/files/read_file.h"

#include <fmt/format.h>

#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {

std::string read_file(const std::string& path, std::size_t max_bytes) {
  const DataFile file(path);
  if (file.size() > max_bytes) {
    throw Error(fmt::format("{}: {} bytes, expected at most {}", path, file.size(), max_bytes));
  }
  return file.read(0, file.size());
}

}  // namespace vesalius
