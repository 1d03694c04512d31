#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/frame_source.h"

namespace vesalius {

/// A camera that is plugged in.
struct SensorInfo {
  std::string id;    ///< what `open` takes: its serial number, or where it is plugged in
  std::string name;  ///< e.g. "PrimeSense PS1080"
};

/// A way to cameras of one kind.
struct SensorDriver {
  std::string_view scheme;  ///< what a source begins with, e.g. "openni2"
  const char* what;         ///< cameras that it opens
  const char* package;      ///< package that a build, or the program, needs for it
  bool built;               ///< whether this build has it
  /// Returns the cameras that are plugged in. Throws Error where the driver does not start.
  std::vector<SensorInfo> (*list)();
  /// Opens the camera with this id, or the only one where it is empty. Throws Error saying what is missing.
  std::unique_ptr<FrameSource> (*open)(const std::string& id);
};

/// Returns the source that names a camera, e.g. "openni2:1", or "openni2" for the only one.
std::string source_of(std::string_view scheme, const std::string& id);

/// Throws Error unless one of `cameras` has this id, or there is one camera and the id is empty. The error names those
/// that there are.
void expect_plugged_in(std::string_view scheme, const std::vector<SensorInfo>& cameras, const std::string& id);

/// Throws Error saying that a camera that is plugged in cannot be opened, why, and what to do: another program may use
/// it, or the user may lack the right.
[[noreturn]] void fail_to_open(const std::string& source, const std::string& reason);

}  // namespace vesalius
