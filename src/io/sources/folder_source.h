#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/sources/list_source.h"

namespace vesalius {

/// Order of names in which numbers count as numbers: frame_2 before frame_10. Total: no two names are equal.
bool natural_less(std::string_view a, std::string_view b);

/// The extension of a path in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// The files in `folder` whose extension (lower case, with its dot) is one of `extensions`, in natural order; hidden
/// files do not count. Throws Error naming the folder when it cannot be read.
std::vector<std::filesystem::path> list_files(const std::string& folder, const std::vector<std::string>& extensions);

/// Depth PNG files in `folder`/depth, partners of the same stem in rgb, color or colour; or in `folder` itself.
FrameList list_folder(const std::string& folder, const SourceOptions& options);

/// One depth PNG; colour from `options`, or, where the file lies in a folder named depth, from the folders beside.
FrameList list_single_png(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
