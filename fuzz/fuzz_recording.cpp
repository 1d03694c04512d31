#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/files/descriptor.h"
#include "io/sources/open_source.h"
#include "vesalius/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vesalius;
  // A file in memory: recordings are read wherever their records say.
  const Descriptor file(::memfd_create("recording", MFD_CLOEXEC));
  if (!file.is_open() || write_all(file, {reinterpret_cast<const char*>(data), size}) != 0) return 0;
  try {
    SourceOptions options;
    options.fx = 100.F;
    const auto source = open_source("recording:/proc/self/fd/" + std::to_string(file.get()), options);
    for (int failed = 0; failed < 3;) {
      try {
        if (!source->next()) break;
      } catch (const Error&) {
        ++failed;
      }
    }
  } catch (const Error&) {
  }
  return 0;
}
