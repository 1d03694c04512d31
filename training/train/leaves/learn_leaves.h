#pragma once

// How the leaves of a forest are learned together (Ren et al., Global refinement of random forest, CVPR 2015), after
// its trees are grown, from the same shards of samples. training_protocol.h has the glossary and the order of messages.

#include <functional>
#include <string>

#include "train/leaves/tree_store.h"
#include "train/messages/leaf_messages.h"
#include "train/messages/training_protocol.h"
#include "vesalius/base/options.h"
#include "vesalius/forest.h"

namespace vesalius {

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

}  // namespace vesalius
