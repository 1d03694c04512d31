#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "downloads/asset_list.h"

namespace vesalius {

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
/// empty, they are taken from the program, made of what the package's sources have, or come from its homes. A file gets
/// its name only after its SHA-256 was checked, as is that of its original. Files that an earlier installation
/// completed are kept; its unfinished ones are removed. Throws Error if a file cannot be fetched, made or written, and
/// if another process is writing in `folder`.
InstallReport install_assets(const AssetPackage& package, const std::string& folder, const std::string& mirror,
                             const InstallWatch& watch, WebOptions options = {});

}  // namespace vesalius
