#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "assets/verified_file.h"

namespace vesalius {

struct FetchOptions {
  double connect_s = 20.0;    ///< time a server has to answer at all
  double stall_s = 30.0;      ///< time a transfer may stay below 100 bytes a second
  int tries = 4;              ///< attempts for each file where a server or the way to it fails
  double first_wait_s = 1.0;  ///< pause before the second try; each later pause is twice as long
  /// Is called several times a second with the bytes of the file at hand so far; by returning false it ends the
  /// transfer with an Error.
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

  /// Writes the file `path`, for which stays_inside() holds, of this place to `file` and returns true; returns false
  /// where there is no such file. The caller commits. Throws Error with the address where the file cannot be had, and
  /// what `file` throws.
  bool get(const std::string& path, VerifiedFile& file);

  /// Returns where `path` is looked for, to be shown in messages: without a password in the address.
  std::string place_of(const std::string& path) const;

 private:
  class Server;

  bool copy(const std::string& path, VerifiedFile& file) const;

  std::string place_;  ///< folder, or address as shown
  FetchOptions options_;
  std::unique_ptr<Server> server_;  ///< null for a folder
};

}  // namespace vesalius
