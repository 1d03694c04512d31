#pragma once

#include <cstdint>
#include <string>

#include "cli/train/train_inputs.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// How training fits the memory it may use.
struct MemoryPlan {
  std::uint64_t bytes = 0;  ///< most that it takes
  int trees_at_once = 1;
};

/// 80 % of the machine's memory, bytes.
std::uint64_t default_memory();

/// Throws Error where training on `inputs` would take more than `limit` bytes, saying how many frames or pixels would
/// fit. `curves`: train_curves() needs some on top.
MemoryPlan plan_memory(const TrainInputs& inputs, const TrainOptions& options, bool curves, std::uint64_t limit);

/// What training will take, measured on some frames: time for each step and in all, memory. Lines of text.
std::string estimate_text(const TrainInputs& inputs, const TrainOptions& options, const MemoryPlan& plan);

}  // namespace vesalius::cli
