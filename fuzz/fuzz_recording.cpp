#include "read_source.h"
#include "vesalius/open_source.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vesalius;
  read_source(data, size, [](const std::string& path) {
    SourceOptions options;
    options.fx = 100.F;
    return open_source("recording:" + path, options);
  });
  return 0;
}
