#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "train/messages/training_messages.h"
#include "train/messages/training_protocol.h"
#include "vesalius/base/options.h"
#include "vesalius/forest.h"
#include "vesalius/forest/facing.h"

// How the leaves of a forest are learned together (Ren et al., Global refinement of random forest, CVPR 2015), after
// its trees are grown, from the same shards of samples. training_protocol.h has the glossary and the order of messages.
namespace vesalius {

/// Where the learning of leaves is.
struct LeafState {
  int rounds = 0;  ///< done
  LeafLogits logits;

  static void visit_fields(auto&& visit, auto&... of) { visit("rounds", of.rounds...)("logits", of.logits...); }
};

/// Keeps the finished trees of a training, and the leaves in learning, so that an interrupted run can be continued. The
/// members about trees may be called from several threads at once.
class TreeStore {
 public:
  virtual ~TreeStore() = default;
  /// Returns a saved tree, or nothing if it was not saved or cannot be read any more.
  virtual std::optional<Tree> load(int number) = 0;
  /// Saves a tree. Throws Error if it cannot.
  virtual void save(int number, const Tree& tree) = 0;
  /// Returns what was saved last, or nothing if nothing was or it cannot be read any more.
  virtual std::optional<LeafState> load_leaves() = 0;
  /// Replaces what was saved before. Throws Error if it cannot.
  virtual void save_leaves(const LeafState& state) = 0;
};

/// Keeps trees in memory.
class MemoryTreeStore : public TreeStore {
 public:
  std::optional<Tree> load(int number) override {
    const std::scoped_lock lock(mutex_);
    const auto found = trees_.find(number);
    return found != trees_.end() ? std::optional(found->second) : std::nullopt;
  }
  void save(int number, const Tree& tree) override {
    const std::scoped_lock lock(mutex_);
    trees_[number] = tree;
  }
  std::optional<LeafState> load_leaves() override { return leaves_; }
  void save_leaves(const LeafState& state) override { leaves_ = state; }

 private:
  std::mutex mutex_;
  std::map<int, Tree> trees_;
  std::optional<LeafState> leaves_;
};

/// Options of how leaves are learned together.
struct LeafLearningOptions {
  int rounds = 0;    ///< steps; 0 leaves a distribution in each leaf
  int headings = 8;  ///< headings that leaves tell apart; 0 or 8
  int portions = 6;  ///< parts of the frames, each round sees one
  /// Share of Newton's step, shared out among all logits that tell the same of a sample: its leaves' of all trees, and
  /// of a part and of its side's headings. Above 2 the steps swing ever further.
  float step = 1.F;
  float prior = 40.F;             ///< samples' weight with which a logit stays where it started
  float lift = 0.15F;             ///< share of a leaf's evidence to start with; 1 takes trees for independent
  float part_balance = 0.9F;      ///< how far classes of few samples count more: 0 not, 1 all parts alike
  float background_weight = 1.F;  ///< what samples of the background count
  float heading_balance = 0.5F;   ///< how far all headings count alike
};
void visit_options(const std::string& prefix, LeafLearningOptions& options, OptionVisitor& visitor);

/// Told after each round with its number, from 0, and the geometric mean of what the true classes get. Returns false to
/// stop.
using LeafRoundEnd = std::function<bool(int round, double likelihood)>;

/// Learns the logits of all leaves by damped Newton steps of every logit for itself. The result depends neither on the
/// number of threads nor on the number of shards. It continues from the round that `store` has, and saves rounds there.
/// Throws Interrupted when `end_round` returns false, with the round saved.
LeafLogits learn_leaves(LeafExecutor& shards, const Forest& forest, const LogitLayout& layout,
                        const LeafLearningOptions& options, TreeStore& store, const LeafRoundEnd& end_round);

/// Rounds logits to bytes and puts them into the forest.
void set_logits(Forest& forest, const LogitLayout& layout, const LeafLogits& logits);

/// Learns the regression of headings by maximum likelihood with a quadratic prior. Each heading counts with its number
/// of people to the power of a half, so that frequent ones are expected half as much more often than they are seen.
/// Returns a model without weights if a heading has nobody.
FacingModel fit_facing(const std::vector<FacingSample>& samples, int parts, int headings);

}  // namespace vesalius
