#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace vesalius {

/// Returns whether a path stays inside the folder to which it is appended. It must not be empty, begin with '/', or
/// contain an empty component, ".", "..", a control character or a backslash.
bool stays_inside(std::string_view path);

/// Receives the files of an archive. `begin` returns whether it wants the bytes of a file. If so, `bytes` gets them in
/// pieces and `end` is called after the last piece.
struct UnpackSink {
  std::function<bool(const std::string& path)> begin;
  std::function<void(std::string_view bytes)> bytes;
  std::function<void()> end;
};

/// Reads a tar archive, compressed or not, from front to back. Throws Error naming the archive if it is damaged, if a
/// path does not stay inside, and if an entry is neither a file nor a folder, such as a link or a device. Passes on
/// what the sink throws.
void unpack(const std::string& archive_path, const UnpackSink& sink);

}  // namespace vesalius
