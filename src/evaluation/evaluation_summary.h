#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vesalius {

/// Returns "12.3 frames/s", or where frames were timed one by one, "41.0 ms a frame".
std::string speed_text(const SetResult& set);

/// Returns what a set came to, for a terminal: one line, and one for each family of shares (parts, postures, joints).
std::string summary_lines(const SetResult& set);

}  // namespace vesalius
