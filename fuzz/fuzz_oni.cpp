#include "io/sources/oni_source.h"
#include "read_source.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vesalius;
  read_source(data, size, [](const std::string& path) {
    SourceOptions options;
    options.colour_topic = "Image";
    return open_oni(path, options);
  });
  return 0;
}
