#include <cstddef>
#include <cstdint>
#include <string>

#include "synth/scene/model_import.h"
#include "vesalius/base/error.h"

/// The input is read as a model in each of the formats. Every file to which the model refers has the same bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  for (const char* name : {"chair.obj", "chair.gltf", "chair.glb"}) {
    try {
      vesalius::synth::import_model(name, [&](const std::string& /*path*/) { return bytes; });
    } catch (const vesalius::Error&) {
    }
  }
  return 0;
}
