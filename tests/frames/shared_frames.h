#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/forest.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// Returns the folder of the developers' real frames, VESALIUS_SHARED or `shared` beside the project; nothing if there
/// is none.
std::optional<std::filesystem::path> shared_folder();

/// One frame of a real set and what is known about it.
struct RealFrame {
  Frame frame;
  int people = -1;  ///< exact number, or -1 if it is not known
  Mask mask;        ///< pixels of people; empty if there is no mask
};

/// Returns all frames of one set in the order of their names.
std::vector<RealFrame> load_real_set(const std::filesystem::path& shared, const std::string& set);

/// Returns the three trees that the paper's authors released.
Forest load_released_trees(const std::filesystem::path& shared);

}  // namespace vesalius

/// Defines `shared`, or skips the test with a message if there are no real frames.
#define VESALIUS_NEEDS_SHARED()                                                                          \
  const auto shared_or_nothing = vesalius::shared_folder();                                              \
  if (!shared_or_nothing) GTEST_SKIP() << "no real frames: set VESALIUS_SHARED to the folder with them"; \
  const std::filesystem::path shared = *shared_or_nothing
