#include "train/samples/sample_accuracy.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>

#include "train/samples/walk_samples.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

double mean_part_recall(const Confusion& confusion, int part_count) {
  double sum = 0.0;
  int parts = 0;
  for (int part = 0; part < part_count; ++part) {
    if (confusion.row_sum(part) == 0) continue;
    sum += confusion.recall(part);
    ++parts;
  }
  return parts > 0 ? sum / parts : 0.0;
}

/// Runs `work(begin, end)` on ranges that cover [0, count), on all allowed threads.
template <class Work>
void for_sample_ranges(std::size_t count, const Work& work) {
  constexpr std::size_t kSamplesPerRange = 2048;
  const std::size_t ranges = (count + kSamplesPerRange - 1) / kSamplesPerRange;
  parallel_for(int(ranges), [&](int r) {
    const std::size_t begin = r * kSamplesPerRange;
    work(begin, std::min(begin + kSamplesPerRange, count));
  });
}

/// Compares the class of largest vote, the lower one on a tie, with the truth. `votes_of(i)` points to one number for
/// each class for sample i.
template <class VotesOf>
SampleAccuracy accuracy_of_votes(const TrainingSet& set, std::span<const TrainingSample> samples,
                                 const VotesOf& votes_of) {
  const int parts = set.body().part_count();
  const int classes = set.class_count();
  SampleAccuracy total{Confusion(classes), Confusion(parts)};
  std::mutex mutex;
  for_sample_ranges(samples.size(), [&](std::size_t begin, std::size_t end) {
    SampleAccuracy here{Confusion(classes), Confusion(parts)};
    for (std::size_t i = begin; i < end; ++i) {
      const auto* votes = votes_of(i);
      const int truth = samples[i].label;
      const auto best_part = std::max_element(votes, votes + parts);
      const auto best = std::max_element(votes, votes + classes);
      ++here.all.at(truth, int(best - votes));
      if (truth < parts) ++here.parts.at(truth, int(best_part - votes));
    }
    const std::scoped_lock lock(mutex);
    for (std::size_t c = 0; c < here.all.counts.size(); ++c) total.all.counts[c] += here.all.counts[c];
    for (std::size_t c = 0; c < here.parts.counts.size(); ++c) total.parts.counts[c] += here.parts.counts[c];
  });
  return total;
}

/// Number of samples for a curve; its standard error is then below 0.004.
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

/// The training samples of each class that pass each node and reach each leaf of one tree.
class NodeCounts {
 public:
  NodeCounts(const Tree& tree, const TrainingSet& set)
      : classes_(set.class_count()),
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

  /// Returns one count for each class; `at` is a node, or ~leaf.
  const std::uint32_t* of(std::int32_t at) const {
    return at >= 0 ? nodes_.data() + at * classes_ : leaves_.data() + ~at * classes_;
  }

 private:
  std::size_t classes_;
  std::vector<std::uint32_t> leaves_, nodes_;
};

/// The sums over trees of the class shares at each level of each sample's walk.
class LevelVotes {
 public:
  LevelVotes(const TrainingSet& set, std::vector<TrainingSample> samples, std::size_t levels)
      : set_(set),
        samples_(std::move(samples)),
        levels_(levels),
        classes_(set.class_count()),
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
  /// Adds the walk of one sample down one tree. Below its leaf the leaf's shares continue.
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

  /// Sets the shares of a node. If no training sample passed it, those of its parent remain.
  void set_shares(const std::uint32_t* counts, std::vector<float>& shares) const {
    std::uint64_t total = 0;
    for (std::size_t c = 0; c < classes_; ++c) total += counts[c];
    if (total == 0) return;
    for (std::size_t c = 0; c < classes_; ++c) {
      shares[c] = float(double(counts[c]) / double(total));
    }
  }

  const TrainingSet& set_;
  std::vector<TrainingSample> samples_;
  std::size_t levels_;
  std::size_t classes_;
  std::vector<float> votes_;  ///< [sample][level][class]
};

}  // namespace

std::uint64_t Confusion::row_sum(int truth) const {
  const auto row = counts.begin() + static_cast<std::ptrdiff_t>(index(truth, 0));
  return std::accumulate(row, row + classes, std::uint64_t{0});
}

double Confusion::recall(int truth) const {
  const std::uint64_t sum = row_sum(truth);
  return sum > 0 ? double(at(truth, truth)) / double(sum) : 0.0;
}

// `parts` has one class for each part, so its size says how many of `all` are parts.
double SampleAccuracy::with_background() const { return mean_part_recall(all, parts.classes); }
double SampleAccuracy::parts_only() const { return mean_part_recall(parts, parts.classes); }

HeldOutVotes::HeldOutVotes(const TrainingSet& set) : set_(set), sums_(set.held_out().size() * set.class_count(), 0) {}

void HeldOutVotes::add(const Tree& tree) {
  const std::span<const TrainingSample> samples = set_.held_out();
  const std::size_t classes = set_.class_count();
  for_sample_ranges(samples.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const TreeLeaf& leaf = tree.leaves[leaf_of(tree, set_.frames(), samples[i])];
      for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
        std::uint16_t& sum = sums_[i * classes + leaf.label[k]];
        sum = static_cast<std::uint16_t>(sum + leaf.probability[k]);
      }
    }
  });
  ++trees_;
}

SampleAccuracy HeldOutVotes::accuracy() const {
  const std::size_t classes = set_.class_count();
  return accuracy_of_votes(set_, set_.held_out(), [&](std::size_t i) { return sums_.data() + i * classes; });
}

SampleAccuracy held_out_accuracy(const Forest& forest, const TrainingSet& set) {
  if (forest.logit_unit == 0.F) {
    HeldOutVotes votes(set);
    for (const Tree& tree : forest.trees) votes.add(tree);
    return votes.accuracy();
  }
  const std::span<const TrainingSample> samples = set.held_out();
  const std::size_t classes = set.class_count();
  std::vector<std::uint16_t> posteriors(samples.size() * classes);
  for_sample_ranges(samples.size(), [&](std::size_t begin, std::size_t end) {
    SampleLogits logits(forest);
    for (std::size_t i = begin; i < end; ++i) logits.read(set.frames(), samples[i], posteriors.data() + i * classes);
  });
  return accuracy_of_votes(set, samples, [&](std::size_t i) { return posteriors.data() + i * classes; });
}

std::vector<AccuracyPoint> accuracy_by_trees(const Forest& forest, const TrainingSet& set) {
  HeldOutVotes votes(set);
  std::vector<AccuracyPoint> points;
  for (const Tree& tree : forest.trees) {
    votes.add(tree);
    const SampleAccuracy accuracy = votes.accuracy();
    points.push_back({accuracy.with_background(), accuracy.parts_only()});
  }
  return points;
}

std::vector<AccuracyPoint> accuracy_by_level(const Forest& forest, const TrainingSet& set) {
  int deepest = 0;
  for (const Tree& tree : forest.trees) deepest = std::max(deepest, depth(tree));
  const std::size_t levels = deepest + 1;
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
