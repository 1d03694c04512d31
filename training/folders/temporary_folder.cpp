#include "folders/temporary_folder.h"

#include <stdlib.h>

#include <filesystem>

#include "vesalius/error.h"

namespace vesalius {

TemporaryFolder::TemporaryFolder() {
  folder_ = (std::filesystem::temp_directory_path() / "vesalius-XXXXXX").string();
  if (::mkdtemp(folder_.data()) == nullptr) throw Error(folder_ + ": folder cannot be made");
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace vesalius
