#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "assets/verified_file.h"

namespace vesalius {

struct AssetFile {
  std::string path;  ///< below the folder of its package; see stays_inside()
  FileDigest digest;
};

/// Files that `vesalius assets` fetches together (data/assets.toml).
struct AssetPackage {
  std::string name;     ///< letters, digits, '_' and '-'; the folder that its files are kept in
  std::string licence;  ///< one line
  std::string credit;   ///< one line: whom to name
  std::string page;     ///< address for people
  /// Addresses that hold the files by their paths, tried in turn; may be none.
  std::vector<std::string> homes;
  AssetFile archive;  ///< holds `name`/`path` for each of the files
  std::vector<AssetFile> files;

  /// Returns the size of all files together.
  std::uint64_t bytes() const;
};

/// Returns the packages that this program knows.
const std::vector<AssetPackage>& asset_packages();

/// Returns the package of this name. Throws UsageError, which lists the known names, where there is none.
const AssetPackage& asset_package(std::string_view name);

/// Parses a list of packages; `name` stands for the path in errors. Throws Error with the line for bad TOML, an unknown
/// or missing key, a value of another type, a name or path twice, a path that leads outside and a malformed SHA-256.
std::vector<AssetPackage> parse_asset_list(std::string_view toml, const std::string& name);

}  // namespace vesalius
