#pragma once

#include <cstdint>
#include <string>

#include "commands/train/train_inputs.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// The memory that training uses.
struct MemoryPlan {
  std::uint64_t bytes = 0;  ///< peak memory of the program
  int trees_at_once = 1;
};

/// Returns 80 % of the machine's memory, in bytes.
std::uint64_t default_memory();

/// Plans the memory of a training on `inputs`: what the program has taken so far, plus frames, samples and trees.
/// `curves` adds what train_curves() needs. Throws Error if the sum exceeds `limit` bytes; it names the sum and how
/// many frames or pixels would fit.
MemoryPlan plan_memory(const TrainInputs& inputs, const TrainOptions& options, bool curves, std::uint64_t limit);

/// Returns lines of text that estimate the memory and time of a training, for each step and in total, from measurements
/// on some frames.
std::string estimate_text(const TrainInputs& inputs, const TrainOptions& options, const MemoryPlan& plan);

}  // namespace vesalius::cli
