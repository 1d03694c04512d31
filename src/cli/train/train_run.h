#pragma once

#include <cstdint>
#include <string>

#include "cli/train/train_inputs.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// How one forest is to be trained, apart from what decides the forest.
struct TrainRun {
  std::string out;              ///< model to write; trees wait in a folder beside it, OUT.work
  std::string report;           ///< folder; empty: none
  bool curves = false;          ///< in the report
  bool restart = false;         ///< forget the trees of an earlier run
  bool shown = true;            ///< say on standard error what goes on
  int trees_at_once = 1;        ///< most trees grown at a time
  std::uint64_t max_bytes = 0;  ///< most that frames and samples may take
};

/// Reads all frames, grows the first round, adds hard negatives, grows the forest, writes model and report. Where an
/// earlier run with the same inputs and options was cut short it goes on, and ends with the same model. Throws Error
/// for unusable frames, more memory than allowed, files that cannot be written, and when the user interrupts: finished
/// trees are kept then.
void train(const TrainRun& run, const TrainOptions& options, const TrainInputs& inputs);

}  // namespace vesalius::cli
