#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/sources/list_source.h"
#include "io/sources/picture_files.h"

namespace vesalius {

/// Returns whether a folder has one of depth in it.
bool has_depth_folder(const std::string& folder);

/// Lists the pictures of depth in the folder of `folder` that is called depth in some way, with colour of that called
/// rgb, color or image; if there is none, those in `folder` itself, with colour beside them by name. They go together
/// by their names, by names without the words of depth and colour, by times within 20 ms where names are times, or by
/// the last numbers of the names. Frames have the times that their names are; else, where meta.json has a rate, their
/// names over the rate if all are whole numbers that rise, so that missing pictures are gaps, otherwise their places in
/// order.
FrameList list_folder(const std::string& folder, const SourceOptions& options);

/// Lists one picture of depth. Its colour file is that of `options`; if none is given it is looked for as list_folder
/// does.
FrameList list_single_picture(const std::string& path, const SourceOptions& options);

}  // namespace vesalius
