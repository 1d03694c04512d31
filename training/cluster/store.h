#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "train/samples/huge_buffer.h"

namespace vesalius {

/// A folder that the driver and the tasks of a cluster all see: a shared folder, or one of HDFS. Names are relative,
/// with '/' between folders, of letters, digits, '.', '_' and '-'. A file is there wholly or not at all. All members
/// throw Error naming the file and the reason; several threads may call them.
class Store {
 public:
  virtual ~Store() = default;

  /// Where it is, as open_store() takes it.
  virtual std::string place() const = 0;
  /// Returns the bytes of a file.
  virtual std::string read(const std::string& name) const = 0;
  /// The same for a large file, whose memory the caller keeps.
  virtual HugeBuffer load(const std::string& name) const { return HugeBuffer(read(name)); }
  virtual bool exists(const std::string& name) const = 0;
  /// Writes a file beside its name and renames it, replacing what was there. Makes the folders that it needs.
  virtual void write(const std::string& name, const std::string& bytes) = 0;
  /// Returns the names of the files and folders in a folder, sorted; none if there is no such folder.
  virtual std::vector<std::string> list(const std::string& folder) const = 0;
  /// Removes a file, or a folder with all that is in it; nothing if there is none.
  virtual void remove(const std::string& name) = 0;
};

/// Opens a folder, or an address webhdfs://HOST:PORT/PATH of HDFS's name node (its port of WebHDFS). The place itself
/// is made when something is written. Throws UsageError for any other address.
std::unique_ptr<Store> open_store(const std::string& place);

/// Returns whether a file of this name is still being written, or was when its writer was killed.
bool is_temporary_name(const std::string& name);

/// Returns whether `name` is relative, of letters, digits, '.', '_' and '-', with single '/' between folders, none of
/// them "." or "..".
bool is_store_name(std::string_view name);

/// Throws UsageError unless `name` is such a name, and not a temporary one.
void check_store_name(const std::string& name);

/// The same for folders that are listed: the empty name is the store itself.
void check_store_folder(const std::string& name);

}  // namespace vesalius
