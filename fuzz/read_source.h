#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "io/files/descriptor.h"
#include "vesalius/error.h"
#include "vesalius/frame_source.h"

namespace vesalius {

/// Reads up to three frames that fail, or all.
inline void read_frames(FrameSource& source) {
  for (int failed = 0; failed < 3;) {
    try {
      if (!source.next()) break;
    } catch (const Error&) {
      ++failed;
    }
  }
}

/// Opens a file in memory, since recordings are read wherever their records say, and reads and seeks in it. `open` gets
/// its path.
template <class Open>
void read_source(const std::uint8_t* data, std::size_t size, const Open& open) {
  const Descriptor file(::memfd_create("recording", MFD_CLOEXEC));
  if (!file.is_open() || write_all(file, {reinterpret_cast<const char*>(data), size}) != 0) return;
  try {
    const std::unique_ptr<FrameSource> source = open("/proc/self/fd/" + std::to_string(file.get()));
    read_frames(*source);
    if (const auto span = source->span()) {
      source->seek(span->first_s + 0.6 * (span->last_s - span->first_s));
      read_frames(*source);
    }
  } catch (const Error&) {
  }
}

}  // namespace vesalius
