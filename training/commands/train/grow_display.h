#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "console/status_line.h"
#include "train/grow_forest.h"
#include "train/samples/sample_accuracy.h"

namespace vesalius::cli {

/// Shows the progress of a round's trees from a thread of its own, and stops them when the user interrupts the program.
class GrowDisplay {
 public:
  /// `trees` trees of up to `max_depth` levels are still to be grown on the samples of `set`, and they report to
  /// `progress`.
  GrowDisplay(const std::string& round, const TrainingSet& set, int trees, int max_depth, GrowProgress& progress,
              bool shown);
  ~GrowDisplay();
  GrowDisplay(const GrowDisplay&) = delete;
  GrowDisplay& operator=(const GrowDisplay&) = delete;

  /// Adds a finished tree; any thread may call this. The display's own thread measures its accuracy, because a worker
  /// that waits for the measurement might be given another tree to grow.
  void add(Tree tree);
  double seconds() const;

 private:
  void watch();
  void measure(const std::vector<Tree>& trees);
  std::string line() const;

  const std::string round_;
  const int trees_;
  const double work_;  ///< samples x levels of all trees
  GrowProgress& progress_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();

  // The following members belong to the thread.
  StatusLine status_;
  const bool judged_;  ///< whether there are held-out samples
  HeldOutVotes votes_;
  std::string accuracy_;  ///< accuracy of the trees so far, as text

  std::mutex mutex_;  ///< guards the following members
  std::condition_variable changed_;
  bool end_ = false;
  std::vector<Tree> done_;  ///< trees not yet measured

  std::thread thread_;  ///< declared last because it uses all other members
};

/// Totals of growing trees.
struct GrowTotals {
  std::uint64_t evaluations = 0;  ///< evaluations of this run, without trees of an earlier one
  double seconds = 0.0;           ///< wall time of this run
  int resumed = 0;                ///< number of trees that an earlier run finished
  std::size_t hard_negatives = 0;
};

/// Shows the rounds of a training and adds up their totals.
class TrainDisplay : public TrainObserver {
 public:
  /// `set` has the samples on which the trees, up to `max_depth` deep, are grown. It must outlive this object.
  TrainDisplay(const TrainingSet& set, int max_depth, bool shown);

  void begin_round(const TreeRound& round, GrowProgress& progress) override;
  void add_tree(const Tree& tree) override;
  void end_round() override;
  void add_hard_negatives(std::size_t samples) override;
  bool end_leaf_round(int round, int rounds, double likelihood) override;

  const GrowTotals& totals() const { return totals_; }
  /// Returns what is done of the last round: "3 of 8 trees of the forest", "the trees and 5 of 24 rounds of leaves".
  std::string done() const;

 private:
  const TrainingSet& set_;
  int max_depth_;
  bool shown_;
  TreeRound round_;
  GrowProgress* progress_ = nullptr;  ///< progress of the current round
  std::optional<GrowDisplay> display_;
  std::atomic<int> grown_{0};  ///< trees of the current round that this run has grown
  GrowTotals totals_;
  std::optional<StatusLine> leaves_;  ///< while leaves are learned
  std::chrono::steady_clock::time_point leaves_start_;
  int leaf_rounds_ = 0;        ///< rounds of leaves done
  int all_leaf_rounds_ = 0;    ///< rounds of leaves to do; 0 before leaves are learned
  int first_leaf_round_ = -1;  ///< first round of this run in which leaves were learned
};

}  // namespace vesalius::cli
