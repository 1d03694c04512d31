#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vesalius {

/// Returns "12.3 frames/s".
std::string speed_text(const SetResult& set);

/// Returns a summary of a set for a terminal: one line, one more for people followed over time, and one for each family
/// of shares (parts, postures, joints).
std::string summary_lines(const SetResult& set);

}  // namespace vesalius
