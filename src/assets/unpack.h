#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace vesalius {

/// Whether a relative path of plain components stays inside the folder that it is appended to: not empty, no leading
/// '/', no empty component, "." or "..", no control character or backslash.
bool stays_inside(std::string_view path);

/// Shown the files of an archive. `begin` says by true that it wants the bytes of a file; `bytes` gives them in pieces,
/// `end` follows the last.
struct UnpackSink {
  std::function<bool(const std::string& path)> begin;
  std::function<void(std::string_view bytes)> bytes;
  std::function<void()> end;
};

/// Reads a tar archive, compressed or not, from front to back. Throws Error naming it for a path that does not stay
/// inside, for a link, a device or another thing that is neither file nor folder, and for a damaged archive; and what
/// the sink throws.
void unpack(const std::string& archive_path, const UnpackSink& sink);

}  // namespace vesalius
