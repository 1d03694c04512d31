#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "downloads/fetch.h"

namespace vesalius {

struct AssetFile {
  std::string path;  ///< relative to the package's folder; stays_inside() holds
  FileDigest digest;
};

/// Files that `vesalius assets` fetches together. data/assets.toml lists them.
struct AssetPackage {
  std::string name;     ///< letters, digits, '_' and '-'; also the name of its folder
  std::string licence;  ///< one line
  std::string credit;   ///< one line that names the authors
  std::string page;     ///< address of a page about the package
  /// Addresses that hold the files by their paths, tried in turn. There may be none.
  std::vector<std::string> homes;
  AssetFile archive;  ///< contains each file as `name`/`path`
  std::vector<AssetFile> files;

  /// Returns the size of all files together.
  std::uint64_t bytes() const;
};

/// Returns the packages that this program can fetch.
const std::vector<AssetPackage>& asset_packages();

/// Returns the package of this name. Throws UsageError, which lists the known names, if there is no such package.
const AssetPackage& asset_package(std::string_view name);

/// Parses a list of packages; `name` is used as the path in errors. Throws Error with the line for invalid TOML, an
/// unknown or missing key, a value of another type, a repeated name or path, a path that leads outside the folder and a
/// malformed SHA-256.
std::vector<AssetPackage> parse_asset_list(std::string_view toml, const std::string& name);

}  // namespace vesalius
