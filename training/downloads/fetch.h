#pragma once

#include <memory>
#include <string>

#include "downloads/verified_file.h"
#include "downloads/web_connection.h"

namespace vesalius {

/// A place from which files are fetched: a folder, or an address that begins with http://, https:// or file://.
class Origin {
 public:
  /// Throws UsageError for any other kind of address and for a folder that does not exist.
  explicit Origin(const std::string& place, WebOptions options = {});

  /// Writes the file `path` of this place to `file` and returns true; returns false if there is no such file.
  /// stays_inside(path) must hold, and the caller has to commit `file`. Throws Error with the address if the file
  /// cannot be fetched, and passes on what `file` throws.
  bool get(const std::string& path, VerifiedFile& file);

  /// Returns the place of `path` for messages; a password in the address is left out.
  std::string place_of(const std::string& path) const;

 private:
  bool ask(const std::string& path, VerifiedFile& file);
  bool copy(const std::string& path, VerifiedFile& file) const;

  std::string place_;  ///< folder, or address as shown
  WebOptions options_;
  std::string address_;                        ///< empty for a folder
  std::unique_ptr<WebConnection> connection_;  ///< null for a folder; kept for the next file
};

}  // namespace vesalius
