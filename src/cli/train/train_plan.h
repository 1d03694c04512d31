#pragma once

#include <cstdint>
#include <string>

#include "cli/train/train_inputs.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// How training fits the memory it may use.
struct MemoryPlan {
  std::uint64_t bytes = 0;  ///< most that the program takes
  int trees_at_once = 1;
};

/// Returns 80 % of the machine's memory, in bytes.
std::uint64_t default_memory();

/// Plans the memory of a training on `inputs`: what the program has taken so far, frames, samples and trees. Throws
/// Error where that is more than `limit` bytes, naming what is needed and how many frames or pixels would fit.
/// `curves`: train_curves() needs some on top.
MemoryPlan plan_memory(const TrainInputs& inputs, const TrainOptions& options, bool curves, std::uint64_t limit);

/// Returns lines of text on what training will take, measured on some frames: time for each step and in all, memory.
std::string estimate_text(const TrainInputs& inputs, const TrainOptions& options, const MemoryPlan& plan);

}  // namespace vesalius::cli
