#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/sources/list_source.h"

namespace vesalius {

/// Compares names such that numbers in them count as numbers: frame_2 comes before frame_10. The order is total: two
/// different names are never equal.
bool natural_less(std::string_view a, std::string_view b);

/// Returns the extension of a path in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// Returns the files in `folder` whose extension (lower case, with its dot) is one of `extensions`, in natural order.
/// Hidden files are left out. Throws Error naming the folder if it cannot be read.
std::vector<std::filesystem::path> list_files(const std::string& folder, const std::vector<std::string>& extensions);

/// Lists the depth PNG files in `folder`/depth, with colour files of the same stem in rgb, color or colour; if there is
/// no folder depth, lists the PNG files in `folder` itself. Where meta.json has a rate, frames have times: their names
/// over the rate if all are whole numbers that rise, so that missing pictures are gaps, otherwise their places in
/// order.
FrameList list_folder(const std::string& folder, const SourceOptions& options);

/// Lists one depth PNG. Its colour file is that of `options`; if none is given and the PNG lies in a folder named
/// depth, it is looked for in the folders beside that.
FrameList list_single_png(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
