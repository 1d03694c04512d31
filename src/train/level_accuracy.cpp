#include <algorithm>
#include <atomic>

#include "train/sample_accuracy.h"
#include "train/sample_votes.h"
#include "train/walk_samples.h"

namespace vesalius {
namespace {

/// A curve needs no more: its standard error is below 0.004 then.
constexpr std::size_t kMostMeasured = 20000;

std::vector<TrainingSample> evenly_chosen(std::span<const TrainingSample> samples) {
  const std::size_t count = std::min(samples.size(), kMostMeasured);
  std::vector<TrainingSample> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(samples[i * samples.size() / count]);
  return chosen;
}

std::int32_t child_of(const Tree& tree, std::int32_t at, const FrameStore& frames, const TrainingSample& sample) {
  const TreeNode& node = tree.nodes[at];
  return feature_of(frames[sample.frame], frames.convention(), sample, node) <= node.threshold_mm ? node.left
                                                                                                  : node.right;
}

/// Training samples of each class that pass each node and reach each leaf of one tree.
class NodeCounts {
 public:
  NodeCounts(const Tree& tree, const TrainingSet& set)
      : classes_(static_cast<std::size_t>(set.class_count())),
        leaves_(tree.leaves.size() * classes_, 0),
        nodes_(tree.nodes.size() * classes_, 0) {
    const std::span<const TrainingSample> samples = set.samples();
    for_sample_ranges(samples.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t at = leaf_of(tree, set.frames(), samples[i]) * classes_ + samples[i].label;
        std::atomic_ref(leaves_[at]).fetch_add(1, std::memory_order_relaxed);
      }
    });
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {  // children come after their parent
      for (const std::int32_t child : {tree.nodes[n].left, tree.nodes[n].right}) {
        for (std::size_t c = 0; c < classes_; ++c) nodes_[n * classes_ + c] += of(child)[c];
      }
    }
  }

  /// One count for each class; `at` is a node, or ~leaf.
  const std::uint32_t* of(std::int32_t at) const {
    return at >= 0 ? nodes_.data() + static_cast<std::size_t>(at) * classes_
                   : leaves_.data() + static_cast<std::size_t>(~at) * classes_;
  }

 private:
  std::size_t classes_;
  std::vector<std::uint32_t> leaves_, nodes_;
};

/// Sums over trees of the class shares where samples stand at each level.
class LevelVotes {
 public:
  LevelVotes(const TrainingSet& set, std::vector<TrainingSample> samples, std::size_t levels)
      : set_(set),
        samples_(std::move(samples)),
        levels_(levels),
        classes_(static_cast<std::size_t>(set.class_count())),
        votes_(samples_.size() * levels_ * classes_, 0.F) {}

  void add(const Tree& tree) {
    const NodeCounts counts(tree, set_);
    for_sample_ranges(samples_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) add_walk(tree, counts, i);
    });
  }

  SampleAccuracy accuracy(std::size_t level) const {
    return accuracy_of_votes(set_, samples_,
                             [&](std::size_t i) { return votes_.data() + (i * levels_ + level) * classes_; });
  }

 private:
  /// One sample down one tree; below its leaf it keeps the leaf's shares.
  void add_walk(const Tree& tree, const NodeCounts& counts, std::size_t i) {
    const TrainingSample& sample = samples_[i];
    std::vector<float> shares(classes_, 0.F);
    std::int32_t at = tree.nodes.empty() ? ~0 : 0;
    for (std::size_t level = 0; level < levels_; ++level) {
      set_shares(counts.of(at), shares);
      float* votes = votes_.data() + (i * levels_ + level) * classes_;
      for (std::size_t c = 0; c < classes_; ++c) votes[c] += shares[c];
      if (at >= 0) at = child_of(tree, at, set_.frames(), sample);
    }
  }

  /// Where no training sample came by, those of the node above stand.
  void set_shares(const std::uint32_t* counts, std::vector<float>& shares) const {
    std::uint64_t total = 0;
    for (std::size_t c = 0; c < classes_; ++c) total += counts[c];
    if (total == 0) return;
    for (std::size_t c = 0; c < classes_; ++c) {
      shares[c] = static_cast<float>(static_cast<double>(counts[c]) / static_cast<double>(total));
    }
  }

  const TrainingSet& set_;
  std::vector<TrainingSample> samples_;
  std::size_t levels_;
  std::size_t classes_;
  std::vector<float> votes_;  ///< [sample][level][class]
};

}  // namespace

std::vector<AccuracyPoint> accuracy_by_level(const Forest& forest, const TrainingSet& set) {
  int deepest = 0;
  for (const Tree& tree : forest.trees) deepest = std::max(deepest, depth(tree));
  const auto levels = static_cast<std::size_t>(deepest) + 1;
  LevelVotes votes(set, evenly_chosen(set.held_out()), levels);
  for (const Tree& tree : forest.trees) votes.add(tree);
  std::vector<AccuracyPoint> points;
  for (std::size_t level = 0; level < levels; ++level) {
    const SampleAccuracy accuracy = votes.accuracy(level);
    points.push_back({accuracy.with_background(), accuracy.parts_only()});
  }
  return points;
}

}  // namespace vesalius
