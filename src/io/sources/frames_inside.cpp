#include "io/sources/frames_inside.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "io/files/depth_picture.h"
#include "io/sources/folder_source.h"
#include "io/sources/list_source.h"
#include "io/sources/recording_files.h"
#include "vesalius/error.h"

namespace vesalius {

namespace fs = std::filesystem;

bool has_frames(const std::string& folder) {
  try {
    const std::vector<fs::path> pictures = list_files(folder, depth_extensions());
    return has_depth_folder(folder) || is_tum_folder(folder) || has_recordings(folder) ||
           !list_files(folder, {".pcd"}).empty() || (!pictures.empty() && may_be_depth(pictures.front().string()));
  } catch (const Error&) {  // a folder that must not be read
    return false;
  }
}

std::string frames_below(const std::string& path) {
  constexpr int kMostLevels = 3, kMostLookedAt = 100'000;
  std::vector<std::pair<int, std::string>> found;
  std::error_code error;
  fs::recursive_directory_iterator it(path, fs::directory_options::skip_permission_denied, error);
  for (int left = kMostLookedAt; !error && left > 0 && it != fs::end(it); it.increment(error), --left) {
    std::error_code ignored;
    if (!it->is_directory(ignored)) continue;
    const bool has = has_frames(it->path().string());
    if (has) found.emplace_back(it.depth(), it->path().string());
    if (has || it.depth() + 1 == kMostLevels) it.disable_recursion_pending();
  }
  return found.empty() ? "" : fmt::format("; {} has some", std::ranges::min_element(found)->second);
}

}  // namespace vesalius
