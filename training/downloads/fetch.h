#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "downloads/verified_file.h"

namespace vesalius {

struct FetchOptions {
  double connect_s = 20.0;    ///< time within which a server must answer
  double stall_s = 30.0;      ///< time for which a transfer may stay below 100 bytes a second
  int tries = 4;              ///< attempts for each file if the server or the network fails
  double first_wait_s = 1.0;  ///< pause before the second try; each later pause is twice as long
  /// This function is called several times a second with the bytes of the current file so far. If it returns false, the
  /// transfer ends with an Error.
  std::function<bool(std::uint64_t bytes)> go_on;
};

/// A place from which files are fetched: a folder, or an address that begins with http://, https:// or file://.
class Origin {
 public:
  /// Throws UsageError for any other kind of address and for a folder that does not exist.
  explicit Origin(const std::string& place, FetchOptions options = {});
  ~Origin();
  Origin(const Origin&) = delete;
  Origin& operator=(const Origin&) = delete;

  /// Writes the file `path` of this place to `file` and returns true; returns false if there is no such file.
  /// stays_inside(path) must hold, and the caller has to commit `file`. Throws Error with the address if the file
  /// cannot be fetched, and passes on what `file` throws.
  bool get(const std::string& path, VerifiedFile& file);

  /// Returns the place of `path` for messages; a password in the address is left out.
  std::string place_of(const std::string& path) const;

 private:
  class Server;

  bool copy(const std::string& path, VerifiedFile& file) const;

  std::string place_;  ///< folder, or address as shown
  FetchOptions options_;
  std::unique_ptr<Server> server_;  ///< null for a folder
};

}  // namespace vesalius
