#pragma once

#include <string>
#include <vector>

#include "evaluation/evaluation.h"

namespace vesalius {

/// Returns one line for each metric of each set, under a header. Commas in the sets' names become semicolons.
std::string evaluation_csv(const Evaluation& evaluation);

}  // namespace vesalius
