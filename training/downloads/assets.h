#pragma once

#include <cstdint>
#include <functional>
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

/// Returns the folder in which assets are kept by default: $VESALIUS_ASSETS, or $XDG_DATA_HOME/vesalius, or
/// ~/.local/share/vesalius, whichever is set first. Each package has a subfolder of its name. An empty variable and an
/// XDG_DATA_HOME that is not an absolute path are ignored. Throws Error if none of the variables is set.
std::string assets_folder();

/// Returns assets_folder(), or "" if none of its variables is set.
std::string default_assets_folder();

/// Returns whether all files of a package are in `folder`. Only names and sizes are compared: install_assets() has
/// already checked the digests, because it gives a file its name only if the digest is right.
bool has_assets(const AssetPackage& package, const std::string& folder);

/// Returns a function that reads a file of a package by its path in the package. The function throws Error naming the
/// file.
std::function<std::string(const std::string& path)> asset_reader(const AssetPackage& package,
                                                                 const std::string& folder);

/// The result of an installation.
struct InstallReport {
  std::size_t fetched = 0;  ///< number of files
  std::size_t kept = 0;     ///< number of files that were there with the right digest
};

/// This function is called several times a second with the number of bytes fetched and to be fetched. If it returns
/// false, the installation ends with an Error.
using InstallWatch = std::function<bool(std::uint64_t done_bytes, std::uint64_t total_bytes)>;

/// Fetches the files of a package that are missing in `folder` or differ from the list. They come from `mirror`, a
/// folder or address that holds the archive or has the files in a subfolder of the package's name; if `mirror` is
/// empty, they come from the package's homes. A file gets its name only after its SHA-256 was checked. Files that an
/// earlier installation completed are kept; its unfinished ones are removed. Throws Error if a file cannot be fetched
/// or written, and if another process is writing in `folder`.
InstallReport install_assets(const AssetPackage& package, const std::string& folder, const std::string& mirror,
                             const InstallWatch& watch, WebOptions options = {});

}  // namespace vesalius
