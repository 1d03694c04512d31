#include <cstddef>
#include <cstdint>

#include "io/files/options_file.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vesalius::DetectOptions options;
  const auto visit = [&](vesalius::OptionVisitor& visitor) { visit_options("", options, visitor); };
  try {
    vesalius::parse_options({reinterpret_cast<const char*>(data), size}, "fuzz", visit);
  } catch (const vesalius::Error&) {
  }
  return 0;
}
