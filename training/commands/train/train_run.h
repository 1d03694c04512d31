#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "commands/train/train_inputs.h"
#include "commands/train/train_plan.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// The settings of a training that are no options.
struct TrainRun {
  std::string out;              ///< model to write; finished trees are kept in OUT.work beside it
  std::string report;           ///< folder of the report; empty for none
  bool curves = false;          ///< whether the report has curves
  bool restart = false;         ///< whether to discard the trees of an earlier run
  bool shown = true;            ///< whether to show progress on standard error
  std::string device = "cpu";   ///< what trains (TrainDevice)
  std::uint64_t max_bytes = 0;  ///< most memory for frames and samples
};

/// Trains a forest: asks for the plan once the device is there, says it, reads all frames, grows the first
/// round, adds hard negatives, grows the forest, and writes model and report. If an earlier run with the same inputs
/// and options was interrupted, its trees are used, and the model is the same as without the interruption. Throws Error
/// for unusable frames, more memory than allowed, files that cannot be written, and when the user interrupts; finished
/// trees are kept in that case.
void train(const TrainRun& run, const TrainOptions& options, const TrainInputs& inputs,
           const std::function<TrainPlan()>& plan);

}  // namespace vesalius::cli
