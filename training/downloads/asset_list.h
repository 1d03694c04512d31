#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "downloads/fetch.h"

namespace vesalius {

struct AssetFile {
  std::string path;  ///< relative to the package's folder; stays_inside() holds
  FileDigest digest;
};

/// A file as it was published, of which packed_motion() makes one of a package.
struct AssetOriginal {
  std::string path;  ///< below the source's home; stays_inside() holds
  FileDigest digest;
  std::string skeleton;  ///< name of an AMC's skeleton; else empty
};

/// A place where files of a package were published in another form.
struct AssetSource {
  std::string home;                                ///< address
  std::string licence;                             ///< one line
  std::string credit;                              ///< one line that names the authors
  std::map<std::string, AssetOriginal> originals;  ///< by the path of the package's file

  /// Returns the size of all originals together.
  std::uint64_t bytes() const;
};

/// Files that `vesalius assets` fetches together. data/assets.toml lists them.
struct AssetPackage {
  std::string name;     ///< letters, digits, '_' and '-'; also the name of its folder
  std::string alias;    ///< another name for it; may be empty
  std::string licence;  ///< one line
  std::string credit;   ///< one line that names the authors
  std::string page;     ///< address of a page about the package
  /// Addresses that hold the files by their paths, tried in turn. There may be none.
  std::vector<std::string> homes;
  std::vector<AssetSource> sources;             ///< what files are made from that no home has
  std::map<std::string, std::string> enclosed;  ///< files that the program holds, by path
  AssetFile archive;                            ///< contains each file as `name`/`path`
  std::vector<AssetFile> files;

  /// Returns the size of all files together.
  std::uint64_t bytes() const;
};

/// Returns the packages that this program can fetch.
const std::vector<AssetPackage>& asset_packages();

/// Returns the package of this name or alias. Throws UsageError, which lists the known names, if there is no such
/// package.
const AssetPackage& asset_package(std::string_view name);

/// Parses a list of packages; `name` is used as the path in errors. Throws Error with the line for invalid TOML, an
/// unknown or missing key, a value of another type, a repeated name or path, a path that leads outside the folder and a
/// malformed SHA-256.
std::vector<AssetPackage> parse_asset_list(std::string_view toml, const std::string& name);

/// Parses a list of sources (data/motions.toml) and throws as parse_asset_list() does.
std::vector<AssetSource> parse_source_list(std::string_view toml, const std::string& name);

}  // namespace vesalius
