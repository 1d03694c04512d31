#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// Folder of the developers' real frames, or nothing where it is absent: VESALIUS_SHARED, else beside the project.
std::optional<std::filesystem::path> shared_folder();

/// One frame of a real set and what is known about it.
struct RealFrame {
  Frame frame;
  int people = -1;  ///< exact count, -1 = some or unknown
  Mask mask;        ///< person pixels, empty where there is none
};

/// All frames of one set in the order of their names.
std::vector<RealFrame> load_real_set(const std::filesystem::path& shared, const std::string& set);

/// The three trees that the paper's authors released.
Forest load_released_trees(const std::filesystem::path& shared);

}  // namespace vesalius

/// Skips the test, saying why, where the real frames are absent; else defines `shared`.
#define VESALIUS_NEEDS_SHARED()                                                                          \
  const auto shared_or_nothing = vesalius::shared_folder();                                              \
  if (!shared_or_nothing) GTEST_SKIP() << "no real frames: set VESALIUS_SHARED to the folder with them"; \
  const std::filesystem::path shared = *shared_or_nothing
