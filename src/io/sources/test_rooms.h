#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/open_source.h"

namespace vesalius::test {

/// Returns the frames of data/rooms.
inline const std::vector<Frame>& rooms() {
  static const std::vector<Frame> frames = [] {
    std::vector<Frame> read;
    const auto source = open_source(std::string(VESALIUS_SOURCE_DIR) + "/data/rooms");
    while (auto frame = source->next()) read.push_back(std::move(*frame));
    return read;
  }();
  return frames;
}

}  // namespace vesalius::test
