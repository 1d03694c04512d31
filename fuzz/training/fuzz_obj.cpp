#include <cstddef>
#include <cstdint>
#include <string_view>

#include "synth/body/makehuman_files.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    vesalius::synth::parse_obj(text, "fuzz.obj", "body");
  } catch (const vesalius::Error&) {
  }
  try {
    vesalius::synth::parse_target(text, "fuzz.target", 100);
  } catch (const vesalius::Error&) {
  }
  return 0;
}
