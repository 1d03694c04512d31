#pragma once

#include <stdlib.h>
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

/// A file that is written anew for each input. It has a name, since SQLite opens no other.
class InputFile {
 public:
  InputFile() : file_(::mkstemp(path_.data())) {}
  ~InputFile() { ::unlink(path_.c_str()); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::string& path() const { return path_; }
  bool write(const std::uint8_t* data, std::size_t size) const {
    return ::ftruncate(file_.get(), 0) == 0 && ::lseek(file_.get(), 0, SEEK_SET) == 0 &&
           write_all(file_, {reinterpret_cast<const char*>(data), size}) == 0;
  }

 private:
  std::string path_ = "/dev/shm/vesalius_fuzz_XXXXXX";
  Descriptor file_;
};

/// Opens a file, since recordings are read wherever their records say, and reads and seeks in it. `open` gets its path.
template <class Open>
void read_source(const std::uint8_t* data, std::size_t size, const Open& open) {
  static const InputFile file;
  if (!file.write(data, size)) return;
  try {
    const std::unique_ptr<FrameSource> source = open(file.path());
    read_frames(*source);
    if (const auto span = source->span()) {
      source->seek(span->first_s + 0.6 * (span->last_s - span->first_s));
      read_frames(*source);
    }
  } catch (const Error&) {
  }
}

}  // namespace vesalius
