#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "assets/asset_list.h"
#include "assets/fetch.h"

namespace vesalius {

/// Returns the folder in which assets are kept by default: $VESALIUS_ASSETS, else $XDG_DATA_HOME/vesalius, else
/// ~/.local/share/vesalius. Each package has a folder of its name in it. Variables that are empty, and an XDG_DATA_HOME
/// that is no absolute path, count as not set. Throws Error where no variable is set.
std::string assets_folder();

/// Returns assets_folder(), or "" where no variable is set.
std::string default_assets_folder();

/// Returns whether all files of a package are in `folder`, judged by name and size. Only install_assets() computes
/// digests: it gives a file its name once the digest is right.
bool has_assets(const AssetPackage& package, const std::string& folder);

/// Returns a function that reads a file of a package by its path in the package and throws Error naming the file.
std::function<std::string(const std::string& path)> asset_reader(const AssetPackage& package,
                                                                 const std::string& folder);

/// What an installation did.
struct InstallReport {
  std::size_t fetched = 0;  ///< number of files
  std::size_t kept = 0;     ///< number of files that were there with the right digest
};

/// Is called several times a second with the bytes fetched and to fetch; by returning false it ends the installation
/// with an Error.
using InstallWatch = std::function<bool(std::uint64_t done_bytes, std::uint64_t total_bytes)>;

/// Fetches what of a package is missing in `folder`, or differs: from `mirror` (a folder or address that holds the
/// archive, or the files below the package's name), or from the package's homes where `mirror` is empty. Nothing gets
/// its name before its SHA-256 was right; what an earlier installation fetched is kept, what it left unfinished goes.
/// Throws Error where a file cannot be had or written, and while another process writes in `folder`.
InstallReport install_assets(const AssetPackage& package, const std::string& folder, const std::string& mirror,
                             const InstallWatch& watch, FetchOptions options = {});

}  // namespace vesalius
