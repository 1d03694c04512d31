#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace vesalius {

/// Returns whether a path stays inside the folder that it is appended to: it is not empty, has no leading '/', no empty
/// component, "." or "..", and no control character or backslash.
bool stays_inside(std::string_view path);

/// Receives the files of an archive. `begin` returns whether it wants the bytes of a file; `bytes` then gets them in
/// pieces, and `end` is called after the last piece.
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
