#pragma once

#include <string>

#include "cluster/map_task.h"
#include "commands/cluster/cluster_flags.h"
#include "commands/train/train_inputs.h"
#include "commands/train/train_run.h"
#include "train/grow_forest.h"

namespace vesalius::cli {

/// How a training on a cluster is divided, besides the engine's flags.
struct TrainClusterFlags {
  ClusterFlags engine;
  int shard_frames = 2000;
  double task_memory_gib = 2.0;  ///< that a map task may take for all shards
};

/// Trains as train() does, with the work done by the tasks of an engine; the model is the same. Finished jobs are kept
/// where --store says until the model is written, so an interrupted run continues. Throws Error as train() and
/// Engine::run do.
void train_on_cluster(const TrainRun& run, const TrainOptions& options, const TrainSources& sources,
                      const TrainClusterFlags& flags);

/// Opens the sources of frames that a text for the tasks of a cluster names; frames are numbered over all inputs.
/// Throws Error for a source that this machine lacks or whose frames would be others than on the machine that wrote the
/// text.
TaskContext::ReadFrame open_frames(const std::string& text);

}  // namespace vesalius::cli
