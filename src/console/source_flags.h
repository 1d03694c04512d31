#pragma once

#include "io/sources/open_source.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// Adds the flags for what the files of SOURCE may not state: --fx --fy --cx --cy --depth-scale --camera --colour
/// --depth-topic --colour-topic.
void add_camera_flags(CLI::App& command, SourceOptions& options);

/// Adds --start, the first frame of SOURCE to take.
void add_start_flag(CLI::App& command, SourceOptions& options);

/// Adds --reconnect, for commands that look at a camera for long. Their SourceOptions::say must be set.
void add_reconnect_flag(CLI::App& command, SourceOptions& options);

/// The text of --help on what SOURCE may be.
inline constexpr const char* kSourceHelp =
    "Frames: a folder (depth/*.png with meta.json or camera_info.yaml, TUM RGB-D, PNG or PCD files), a 16-bit depth "
    "PNG, an organised PCD file, a recording (MCAP, ROS 1 .bag, ROS 2 .db3, .mkv), or a camera that "
    "`vesalius cameras` lists; tum:FOLDER:SCALE and similar prefixes state the kind";

}  // namespace vesalius::cli
