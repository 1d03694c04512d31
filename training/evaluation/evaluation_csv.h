#pragma once

#include <string>
#include <vector>

#include "evaluation/evaluation.h"

namespace vesalius {

/// Returns one line for each metric of each set, under a header. Commas in the sets' names become semicolons.
std::string evaluation_csv(const Evaluation& evaluation);

/// Returns a line for each set, variant and metric, under a header. The variant "" is the unchanged method.
std::string ablation_csv(const std::vector<SetResult>& sets);

}  // namespace vesalius
