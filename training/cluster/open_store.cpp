#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>

#include "cluster/store.h"
#include "cluster/webhdfs_store.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

void check(const std::error_code& error, const std::string& path, const char* what) {
  if (error) throw Error(fmt::format("{}: {}: {}", path, what, error.message()));
}

std::string absolute(const std::string& folder) {
  if (folder.empty()) throw UsageError("expected a folder, the name is empty");
  std::error_code error;
  std::string path = fs::absolute(folder, error).lexically_normal().string();
  check(error, folder, "cannot be found");
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path;
}

/// A folder that all machines see under the same path.
class FolderStore : public Store {
 public:
  /// The folder need not exist: write() makes it. Throws UsageError if `folder` is empty.
  explicit FolderStore(const std::string& folder) : folder_(absolute(folder)) {}

  /// The folder's absolute path, since others may run elsewhere.
  std::string place() const override { return folder_; }

  std::string read(const std::string& name) const override {
    return read_file(path_of(name), std::numeric_limits<std::size_t>::max());
  }

  HugeBuffer load(const std::string& name) const override {
    const DataFile file(path_of(name));
    HugeBuffer buffer(file.size());
    const std::size_t size = file.read_into(0, {buffer.data(), buffer.size()});
    if (size != buffer.size()) throw Error(fmt::format("{}: {} bytes, expected {}", file.path(), size, buffer.size()));
    return buffer;
  }

  bool exists(const std::string& name) const override {
    const std::string path = path_of(name);
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) return false;
    check(error, path, "cannot be found");
    return true;
  }

  void write(const std::string& name, const std::string& bytes) override {
    const std::string path = path_of(name);
    std::error_code error;
    fs::create_directories(fs::path(path).parent_path(), error);
    check(error, path, "its folder cannot be made");
    write_file_atomically(path, bytes);
  }

  std::vector<std::string> list(const std::string& folder) const override {
    check_store_folder(folder);
    const std::string path = folder.empty() ? folder_ : path_of(folder);
    std::vector<std::string> names;
    std::error_code error;
    fs::directory_iterator entry(path, error);
    if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) return names;
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
      names.push_back(entry->path().filename().string());
    }
    check(error, path, "cannot be listed");
    std::erase_if(names, is_temporary_name);
    std::sort(names.begin(), names.end());
    return names;
  }

  void remove(const std::string& name) override {
    const std::string path = path_of(name);
    std::error_code error;
    fs::remove_all(path, error);
    if (error == std::errc::not_a_directory) return;  // a file stands where its folder would be: there is none
    check(error, path, "cannot be removed");
  }

 private:
  std::string path_of(const std::string& name) const {
    check_store_name(name);
    return (fs::path(folder_) / name).string();
  }

  std::string folder_;
};

}  // namespace

std::unique_ptr<Store> open_store(const std::string& place) {
  if (WebHdfsStore::takes(place)) return std::make_unique<WebHdfsStore>(place);
  if (place.find("://") != place.npos) {
    throw UsageError(place + ": expected a folder, or an address webhdfs://HOST:PORT/PATH");
  }
  return std::make_unique<FolderStore>(place);
}

}  // namespace vesalius
