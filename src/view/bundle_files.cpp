#include "view/bundle_files.h"

#include <cstddef>

namespace vesalius {
namespace {

// CMake writes the bytes of bundle/*.gz.
#include "bundle_bytes.inc"

template <std::size_t size>
std::string_view text(const unsigned char (&bytes)[size]) {
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace

const std::vector<BundleFile>& bundle_files() {
  static const std::vector<BundleFile> files{{"/", "text/html; charset=utf-8", text(k_index_html)},
                                             {"/view.css", "text/css; charset=utf-8", text(k_view_css)},
                                             {"/view.js", "text/javascript; charset=utf-8", text(k_view_js)}};
  return files;
}

}  // namespace vesalius
