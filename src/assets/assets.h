#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "assets/asset_list.h"
#include "assets/fetch.h"

namespace vesalius {

/// Where assets are kept unless told otherwise: $VESALIUS_ASSETS, else $XDG_DATA_HOME/vesalius, else
/// ~/.local/share/vesalius; a package in a folder of its name below. Variables that are empty, and an XDG_DATA_HOME
/// that is no absolute path, count as not there. Throws Error where none says.
std::string assets_folder();

/// Returns assets_folder(), or "" where nothing says where that is.
std::string default_assets_folder();

/// Whether all files of a package are in `folder`, by name and size. `install_assets` alone looks at the sums: a file
/// has its name only once its sum was right.
bool has_assets(const AssetPackage& package, const std::string& folder);

/// Reads files of a package by their paths in it; throws Error naming the file.
std::function<std::string(const std::string& path)> asset_reader(const AssetPackage& package,
                                                                 const std::string& folder);

/// What an installation did.
struct InstallReport {
  std::size_t fetched = 0;  ///< files
  std::size_t kept = 0;     ///< files that were there with the right sum
};

/// Told of the bytes fetched and to fetch, several times a second; false ends the installation with an Error.
using InstallWatch = std::function<bool(std::uint64_t done_bytes, std::uint64_t total_bytes)>;

/// Fetches what of a package is missing in `folder`, or differs: from `mirror` (a folder or address that holds the
/// archive, or the files below the package's name), or from the package's homes where `mirror` is empty. Nothing gets
/// its name before its SHA-256 was right; what an earlier installation fetched is kept, what it left unfinished goes.
/// Throws Error where a file cannot be had or written, and where another installation is at work in `folder`.
InstallReport install_assets(const AssetPackage& package, const std::string& folder, const std::string& mirror,
                             const InstallWatch& watch, FetchOptions options = {});

}  // namespace vesalius
