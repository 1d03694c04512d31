#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cli/status_line.h"
#include "train/grow_forest.h"
#include "train/sample_accuracy.h"

namespace vesalius::cli {

/// While it lives, shows from a thread of its own how far the trees of a round are, and stops them when the user
/// interrupts the program.
class GrowDisplay {
 public:
  /// `trees` are still to grow, of `max_depth` on the samples of `set`. `progress` is what they write to.
  GrowDisplay(const std::string& round, const TrainingSet& set, int trees, int max_depth, GrowProgress& progress,
              bool shown);
  ~GrowDisplay();
  GrowDisplay(const GrowDisplay&) = delete;
  GrowDisplay& operator=(const GrowDisplay&) = delete;

  /// A tree is done; from any thread. Its accuracy is measured by the display's own: a worker would have to wait, and
  /// might be given another tree to grow meanwhile.
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

  // The thread's own.
  StatusLine status_;
  const bool judged_;  ///< whether there are held-out samples
  HeldOutVotes votes_;
  std::string accuracy_;  ///< of the trees so far, as text

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  bool end_ = false;
  std::vector<Tree> done_;  ///< not yet measured

  std::thread thread_;  ///< last: it uses all of the above
};

/// What growing trees came to.
struct GrowTotals {
  std::uint64_t evaluations = 0;  ///< of this run; trees of an earlier one do not count
  double seconds = 0.0;           ///< wall time of it
  int resumed = 0;                ///< trees that an earlier run had done
  std::size_t hard_negatives = 0;
};

/// Shows the rounds of a training and adds up what they come to.
class TrainDisplay : public TrainObserver {
 public:
  /// `set` is what the trees, at most `max_depth` deep, are grown on; it must outlive this.
  TrainDisplay(const TrainingSet& set, int max_depth, bool shown);

  void begin_round(const TreeRound& round, GrowProgress& progress) override;
  void add_tree(const Tree& tree) override;
  void end_round() override;
  void add_hard_negatives(std::size_t samples) override;

  const GrowTotals& totals() const { return totals_; }
  /// How far the last round came: "3 of 8 trees of the forest".
  std::string done() const;

 private:
  const TrainingSet& set_;
  int max_depth_;
  bool shown_;
  TreeRound round_;
  GrowProgress* progress_ = nullptr;  ///< of the round that goes on
  std::optional<GrowDisplay> display_;
  std::atomic<int> grown_{0};  ///< trees of the round, by this run
  GrowTotals totals_;
};

}  // namespace vesalius::cli
