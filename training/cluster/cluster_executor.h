#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cluster/engine.h"
#include "cluster/message.h"
#include "cluster/train_job.h"
#include "train/messages/training_protocol.h"
#include "train/samples/training_set.h"

namespace vesalius {

/// How a training is divided among machines. The forest depends on none of this.
struct ClusterPlan {
  std::uint64_t shard_frames = 2000;  ///< frames of a shard
  int map_tasks = 1;                  ///< tasks that run at the same time
  std::uint64_t task_memory = 0;      ///< bytes that a map task may take for all sets, to grow whole subtrees
};

/// What is trained, from which frames.
struct ClusterTraining {
  Forest forest;  ///< without trees
  TrainOptions options;
  std::string source;        ///< how tasks open the frames (TaskContext::open_source)
  std::uint64_t frames = 0;  ///< behind the backgrounds
  /// Sets that the driver made itself, of the frames that come first.
  std::vector<const TrainingSet*> backgrounds = {};
};

/// Carries the requests of the training protocol to the tasks of an engine. Each request is one job or two a level, and
/// the jobs' results stay in the store until `clear`: a driver that was killed asks for the same jobs again and goes on
/// behind the last one that ended.
class ClusterExecutor : public Executor {
 public:
  /// Draws the samples of all shards, which is the first job. Throws Error as Engine::run does, and for a damaged
  /// result.
  ClusterExecutor(Engine& engine, ClusterTraining training, const ClusterPlan& plan);

  void grow_trees(const Forest& forest, const GrowTreeOptions& options, const std::vector<int>& numbers,
                  GrowProgress& progress, const TakeTree& take) override;
  HardCounts count_hard_negatives(const Forest& forest) override;
  std::size_t add_hard_negatives(const HardCut& cut) override;
  std::unique_ptr<LeafExecutor> begin_leaves(const Forest& forest, const LogitLayout& layout) override;
  std::vector<FacingSample> facing_samples(const Forest& forest) override;

  /// Facts of all shards together.
  PreparedShard total() const;
  std::size_t shards() const { return first_frames_.size() - 1; }
  /// Ends what is left of jobs, and removes all jobs and sets from the engine's store.
  static void clear(Engine& engine);

 private:
  friend class ClusterLeaves;
  class Round;
  using Records = std::map<std::string, std::string>;  ///< message of each key

  TrainJob new_job(JobKind kind, const std::string& name) const;
  /// Runs a job over lines 0 .. `lines` - 1 in this order, unless its result is there.
  Records run(const TrainJob& job, const std::vector<std::size_t>& lines, bool reduced);
  Records run_over_shards(const TrainJob& job, bool reduced);
  Records results(const std::string& job) const;
  void take_prepared(const Records& records, const std::string& job);

  Engine& engine_;
  ClusterTraining training_;
  ClusterPlan plan_;
  std::vector<std::uint64_t> first_frames_;
  std::vector<PreparedShard> prepared_;
  std::vector<HardCounts> hard_;  ///< hard samples of each shard, counted last
  Forest hard_forest_;
  std::string sets_ = "sets-0";
};

}  // namespace vesalius
