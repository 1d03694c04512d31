#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "assets/verified_file.h"

namespace vesalius {

struct FetchOptions {
  double connect_s = 20.0;    ///< for a server to answer at all
  double stall_s = 30.0;      ///< with fewer than 100 bytes a second
  int tries = 4;              ///< where a server or the way to it fails
  double first_wait_s = 1.0;  ///< before the second try; each later one waits twice as long
  /// Asked several times a second with the bytes of the file at hand so far; false ends the transfer with an Error.
  std::function<bool(std::uint64_t bytes)> go_on;
};

/// A place that files are fetched from: a folder, or an address that begins with http://, https:// or file://.
class Origin {
 public:
  /// Throws UsageError for an address of another kind and for a folder that is not there.
  explicit Origin(const std::string& place, FetchOptions options = {});
  ~Origin();
  Origin(const Origin&) = delete;
  Origin& operator=(const Origin&) = delete;

  /// Writes the file `path` (as of `stays_inside`) of this place to `file`; false where there is none. Throws Error,
  /// with the address, where it cannot be had, and what `file` throws. Does not commit.
  bool get(const std::string& path, VerifiedFile& file);

  /// Where `path` is looked for, for messages: without a password in the address.
  std::string place_of(const std::string& path) const;

 private:
  class Server;

  bool copy(const std::string& path, VerifiedFile& file) const;

  std::string place_;  ///< folder, or address as shown
  FetchOptions options_;
  std::unique_ptr<Server> server_;  ///< null for a folder
};

}  // namespace vesalius
