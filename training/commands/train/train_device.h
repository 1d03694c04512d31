#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "train/messages/training_protocol.h"
#include "train/samples/training_set.h"

namespace vesalius::cli {

/// Makes an executor over the sets, which grows at most so many trees at a time (train/local_executor.h).
using MakeExecutor = std::function<std::unique_ptr<Executor>(const std::vector<TrainingSet*>&, int trees_at_once)>;

/// What trains: the processor, or one or more cards (`vesalius train --device`).
class TrainDevice {
 public:
  /// Takes a name as on_device does, or several of one kind with commas between. Throws UsageError for a device
  /// that this build does not know and DeviceError for one that this machine does not have. What "auto" decides is said
  /// on standard error.
  explicit TrainDevice(const std::string& names);

  /// Calls `train` with an executor over the sets. Where any device will do and one fails, a note is said and `train`
  /// is called again with an executor on the processor; what it stored until then is not done again.
  void run(const std::vector<TrainingSet*>& sets, int trees_at_once, const std::function<void(Executor&)>& train) const;

 private:
  MakeExecutor make_;  ///< empty for the processor
  bool any_ = false;
};

}  // namespace vesalius::cli
