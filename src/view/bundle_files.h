#pragma once

#include <string_view>
#include <vector>

namespace vesalius {

/// A file of the page, compressed by gzip.
struct BundleFile {
  std::string_view path;  ///< what a browser asks for, e.g. "/view.js"
  std::string_view type;  ///< MIME type
  std::string_view gzip;
};

/// Returns the files of the page.
const std::vector<BundleFile>& bundle_files();

}  // namespace vesalius
