#pragma once

#include <cstdint>
#include <string>

#include "commands/train/train_inputs.h"
#include "train/grow_forest.h"
#include "vesalius/forest.h"

namespace vesalius::cli {

/// What a training will take, about: some of its frames were measured, the rest is multiplication.
struct TrainPlan {
  std::uint64_t bytes = 0;  ///< bytes of the whole program
  double seconds = 0.0;
  int trees_at_once = 1;   ///< trees whose memory the limit allows, at most one for each thread
  double reading_s = 0.0;  ///< the part of `seconds` that goes into reading the frames
  std::string steps;       ///< lines for the user, a step each
  Forest pilot;            ///< forest of one tree, grown on the frames that were measured

  /// Returns all lines for the user: steps, time, memory.
  std::string text() const;
};

/// Returns seconds as text: "47 s", "89 min", "3.2 h".
std::string duration(double seconds);

/// Returns 80 % of the machine's memory, in bytes.
std::uint64_t default_memory();

/// Reads one frame of 30, at most 50, and grows a tree on them. `curves` adds what train_curves() needs.
/// Throws Error if the training would take more than `limit` bytes, with what can be done about it.
TrainPlan plan_training(const TrainInputs& inputs, const TrainOptions& options, bool curves, std::uint64_t limit);

}  // namespace vesalius::cli
