#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "cli/status_line.h"
#include "train/grow_tree.h"
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

}  // namespace vesalius::cli
