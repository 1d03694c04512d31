#include "train/grow_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "train/feature_rows.h"
#include "train/frame_prefetcher.h"
#include "train/huge_buffer.h"
#include "train/leaf_shares.h"
#include "train/prune_tree.h"
#include "train/split_candidates.h"
#include "train/split_histogram.h"
#include "train/walk_samples.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"

namespace vesalius {
namespace {

constexpr std::int32_t kSettled = -1;  ///< a sample that has reached a leaf
constexpr std::uint32_t kNoRow = std::numeric_limits<std::uint32_t>::max();
constexpr int kGrain = 8192;       ///< samples that a thread takes at a time
constexpr std::size_t kAhead = 3;  ///< samples whose table and row are asked for beforehand
/// Samples of a frame from which on unpacking all of it pays: all candidates at each, and one feature at each.
constexpr double kFewEvaluated = 12.0, kFewRouted = 150.0;
/// Nodes are numbered as in a heap, root 1, children 2n and 2n + 1: no number repeats within this depth.
constexpr int kDeepest = 30;

/// A node of the level being grown.
struct OpenNode {
  std::uint32_t number = 1;  ///< in a heap
  std::size_t at = 0;        ///< in the tree being built
  std::int64_t size = 0;     ///< samples
  std::int64_t counted = 0;  ///< of them, those that choose the split: each has a row
  std::int64_t row_begin = 0;
  TreeNode split;
  double gain = 0;      ///< bits a sample; 0 = none found
  bool routed = false;  ///< side of every sample is known from the rows
};

/// Nodes [begin, end) of a level, whose rows fit the memory for them.
struct Group {
  std::size_t begin = 0, end = 0;
  std::int64_t row_begin = 0, row_end = 0;
};

/// Rows of one group for one block of candidates. Kept from group to group.
struct RowBlock {
  int width = 0;
  HugeBuffer values{0};
  std::vector<std::uint8_t> labels;
  std::vector<std::uint32_t> samples;

  void resize(std::size_t rows, int columns) {
    width = columns;
    const std::size_t bytes = rows * static_cast<std::size_t>(columns) * sizeof(std::int16_t);
    if (values.size() < bytes) values = HugeBuffer(bytes);
    labels.resize(rows);
    samples.resize(rows);
  }
  std::size_t row_bytes() const { return static_cast<std::size_t>(width) * sizeof(std::int16_t); }
  std::int16_t* row(std::size_t index) const {
    return reinterpret_cast<std::int16_t*>(values.data()) + index * static_cast<std::size_t>(width);
  }
};

/// Candidates of many nodes, as CandidateTable lays them out.
struct NodeTables {
  int count = 0, padded = 0;
  std::vector<std::int16_t> offsets;

  std::size_t length() const { return 4 * static_cast<std::size_t>(padded); }
  std::size_t bytes() const { return length() * sizeof(std::int16_t); }
  std::int16_t* at(std::size_t node) { return offsets.data() + node * length(); }
};

/// Neighbouring samples are in nodes far apart: without this each waits for its node's table and row.
void prefetch_lines(const void* from, std::size_t bytes) {
  const char* at = static_cast<const char*>(from);
  for (std::size_t i = 0; i < bytes; i += kLineBytes) __builtin_prefetch(at + i, 0, 3);
}

/// Grows a tree level by level. Within a level samples are evaluated in the order of their frames, whatever node they
/// are in: a frame is read from memory once for all of its samples and stays in the cache meanwhile. The values go to
/// rows ordered by node, from which each node then chooses its split.
class LevelGrower {
 public:
  LevelGrower(const TrainingSet& set, const GrowTreeOptions& options, int tree, GrowProgress& progress)
      : set_(set),
        samples_(set.samples()),
        options_(options),
        tree_(tree),
        progress_(progress),
        classes_(static_cast<std::size_t>(set.class_count())),
        shares_(set, options.leaf.prior_correction, options.leaf.part_balance),
        node_of_(samples_.size(), 0),
        row_of_(samples_.size(), kNoRow),
        on_right_(samples_.size(), 0) {}

  Tree grow() {
    start();
    for (int depth = 0; !level_.empty(); ++depth) {
      assign_rows();
      for (const Group& group : groups()) choose_splits(group);
      route_the_rest();
      descend(depth + 1);
    }
    return pruned_tree(built_);
  }

 private:
  void start() {
    child_counts_.assign(classes_, 0);
    for (const TrainingSample& sample : samples_) ++child_counts_[sample.label];
    built_.emplace_back();
    open_or_settle(1, 0, child_counts_.data(), 0);
  }

  /// Makes a node of the next level, or a leaf where nothing is left to ask.
  std::int32_t open_or_settle(std::uint32_t number, std::size_t at, const std::int64_t* counts, int depth) {
    std::int64_t size = 0;
    int present = 0;
    for (std::size_t c = 0; c < classes_; ++c) {
      size += counts[c];
      present += counts[c] > 0 ? 1 : 0;
    }
    built_[at].leaf = shares_.leaf(counts);
    if (depth >= options_.leaf.max_depth || present < 2 || size < 2 * options_.leaf.min_samples) {
      settle(size, depth);
      return kSettled;
    }
    OpenNode node;
    node.number = number;
    node.at = at;
    node.size = size;
    node.counted = std::min<std::int64_t>(size, options_.split.split_pixels);
    level_.push_back(node);
    return static_cast<std::int32_t>(level_.size() - 1);
  }

  void settle(std::int64_t size, int depth) {
    progress_.settled += static_cast<std::uint64_t>(size * (options_.leaf.max_depth - depth));
  }

  /// Gives a row to every counted sample, evenly spaced over those of its node.
  void assign_rows() {
    std::int64_t row = 0;
    for (OpenNode& node : level_) {
      node.row_begin = row;
      row += node.counted;
    }
    std::vector<std::int64_t> seen(level_.size(), 0);
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      row_of_[s] = kNoRow;
      if (node_of_[s] == kSettled) continue;
      const auto n = static_cast<std::size_t>(node_of_[s]);
      const OpenNode& node = level_[n];
      const std::int64_t rank = seen[n]++;
      if (node.counted == node.size) {
        row_of_[s] = static_cast<std::uint32_t>(node.row_begin + rank);
        continue;
      }
      const std::int64_t before = rank * node.counted / node.size;
      if ((rank + 1) * node.counted / node.size > before) {
        row_of_[s] = static_cast<std::uint32_t>(node.row_begin + before);
      }
    }
  }

  std::vector<Group> groups() const {
    const auto most = static_cast<std::int64_t>(options_.row_bytes / (sizeof(std::int16_t) * kBlockCandidates));
    std::vector<Group> groups;
    for (std::size_t n = 0; n < level_.size(); ++n) {
      const std::int64_t end = level_[n].row_begin + level_[n].counted;
      if (groups.empty() || end - groups.back().row_begin > most) {
        groups.push_back({n, n, level_[n].row_begin, level_[n].row_begin});
      }
      groups.back().end = n + 1;
      groups.back().row_end = end;
    }
    return groups;
  }

  void choose_splits(const Group& group) {
    for (int block = 0; block < candidate_blocks(options_.split); ++block) {
      if (progress_.stop) throw Error("training: interrupted");
      draw_tables(group, block);
      evaluate(group);
      parallel_for(static_cast<int>(group.end - group.begin), [&](int i) {
        const std::size_t n = group.begin + static_cast<std::size_t>(i);
        choose_split(level_[n], node_candidates(set_.convention(), options_, tree_, level_[n].number, block),
                     group.row_begin);
      });
      progress_.evaluations +=
          static_cast<std::uint64_t>(group.row_end - group.row_begin) * static_cast<std::uint64_t>(tables_.count);
    }
  }

  /// Candidates of one block for every node of a group, one after the other.
  void draw_tables(const Group& group, int block) {
    const auto draw = [&](std::size_t n) {
      return node_candidates(set_.convention(), options_, tree_, level_[n].number, block);
    };
    const CandidateTable first = draw(group.begin);
    tables_.count = first.count;
    tables_.padded = first.padded;
    tables_.offsets.resize((group.end - group.begin) * first.offsets.size());
    parallel_for(static_cast<int>(group.end - group.begin), [&](int i) {
      const CandidateTable table = draw(group.begin + static_cast<std::size_t>(i));
      std::ranges::copy(table.offsets, tables_.at(static_cast<std::size_t>(i)));
    });
  }

  void evaluate(const Group& group) {
    rows_.resize(group.row_end - group.row_begin, tables_.padded);
    const FrameStore& frames = set_.frames();
    const bool few =
        static_cast<double>(group.row_end - group.row_begin) < kFewEvaluated * static_cast<double>(frames.size());
    const auto has_row = [&](std::size_t s) {
      return row_of_[s] != kNoRow && row_of_[s] >= group.row_begin && row_of_[s] < group.row_end;
    };
    const auto row_at = [&](std::size_t s) { return row_of_[s] - static_cast<std::size_t>(group.row_begin); };
    const auto table_at = [&](std::size_t s) {
      return tables_.at(static_cast<std::size_t>(node_of_[s]) - group.begin);
    };
    parallel_ranges(static_cast<int>(samples_.size()), kGrain, [&](int begin, int end) {
      FramePrefetcher prefetcher(frames, samples_);
      FrameUnpacker unpack(frames);
      for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
        if (!few) prefetcher.step(s);
        const std::size_t later = s + kAhead;
        if (later < static_cast<std::size_t>(end) && has_row(later)) {
          prefetch_lines(table_at(later), tables_.bytes());
          prefetch_lines(rows_.row(row_at(later)), rows_.row_bytes());
        }
        if (!has_row(s)) continue;
        const TrainingSample& sample = samples_[s];
        const auto evaluate_on = [&](const auto& depth) {
          evaluate_candidates(depth, set_.convention(), sample, table_at(s), tables_.padded, rows_.row(row_at(s)));
        };
        if (few) {
          evaluate_on(frames[sample.frame]);
        } else {
          evaluate_on(unpack(sample.frame));
        }
        rows_.labels[row_at(s)] = sample.label;
        rows_.samples[row_at(s)] = static_cast<std::uint32_t>(s);
      }
    });
  }

  void choose_split(OpenNode& node, const CandidateTable& table, std::int64_t first_row) {
    const auto begin = static_cast<std::size_t>(node.row_begin - first_row);
    const FeatureRows rows{rows_.row(begin), rows_.labels.data() + begin, static_cast<std::size_t>(node.counted),
                           rows_.width};
    const ClassIndex classes = index_classes(rows, static_cast<int>(classes_));
    ValueRanges ranges(rows.width);
    ranges.add(rows);
    const Binning binning(ranges, bins_for(node.counted, options_.split.bins));
    SplitHistogram histogram;
    histogram.reset(classes.size(), binning.bins);
    histogram.add(rows, binning, classes);
    const auto least = static_cast<int>((options_.leaf.min_samples * node.counted + node.size - 1) / node.size);
    const BinSplit best = best_split(histogram, table.count, classes, least, entropy_);
    if (best.candidate < 0) return;
    const ThresholdSplit refined = refine_split(rows, best, binning, classes, least, entropy_);
    if (refined.gain < static_cast<double>(options_.split.min_gain) || refined.gain <= node.gain) return;
    node.gain = refined.gain;
    node.split = table.node(best.candidate);
    node.split.threshold_mm = static_cast<std::int16_t>(refined.threshold_mm);
    if (candidate_blocks(options_.split) == 1 && node.counted == node.size)
      route(node, best.candidate, rows, &rows_.samples[begin]);
  }

  /// Sends samples to a side by the values at hand.
  void route(OpenNode& node, int candidate, const FeatureRows& rows, const std::uint32_t* samples) {
    const std::int16_t* value = rows.values + candidate;
    for (std::size_t r = 0; r < rows.rows; ++r, value += rows.width) {
      on_right_[samples[r]] = *value > node.split.threshold_mm ? 1 : 0;
    }
    node.routed = true;
  }

  /// The same for nodes that had not all samples in rows.
  void route_the_rest() {
    const auto unrouted = [](const OpenNode& node) { return !node.routed && node.gain > 0.0; };
    std::int64_t samples = 0;
    for (const OpenNode& node : level_) samples += unrouted(node) ? node.size : 0;
    if (samples == 0) return;
    const FrameStore& frames = set_.frames();
    const bool few = static_cast<double>(samples) < kFewRouted * static_cast<double>(frames.size());
    parallel_ranges(static_cast<int>(samples_.size()), kGrain, [&](int begin, int end) {
      FrameUnpacker unpack(frames);
      for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
        if (node_of_[s] == kSettled) continue;
        const OpenNode& node = level_[node_of_[s]];
        if (!unrouted(node)) continue;
        const TrainingSample& sample = samples_[s];
        const int value = few ? feature_of(frames[sample.frame], set_.convention(), sample, node.split)
                              : feature_of(unpack(sample.frame), set_.convention(), sample, node.split);
        on_right_[s] = value > node.split.threshold_mm ? 1 : 0;
      }
    });
  }

  /// Makes the children and moves all samples to them.
  void descend(int depth) {
    child_counts_.assign(2 * level_.size() * classes_, 0);
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      if (node_of_[s] == kSettled) continue;
      const std::size_t child = 2 * static_cast<std::size_t>(node_of_[s]) + on_right_[s];
      ++child_counts_[child * classes_ + samples_[s].label];
    }
    const std::vector<OpenNode> parents = std::move(level_);
    level_.clear();
    std::vector<std::int32_t> child_of(2 * parents.size(), kSettled);
    for (std::size_t n = 0; n < parents.size(); ++n) {
      const OpenNode& parent = parents[n];
      if (parent.gain <= 0.0) {
        settle(parent.size, depth - 1);
        continue;
      }
      progress_.settled += static_cast<std::uint64_t>(parent.size);
      ++progress_.nodes;
      const std::size_t left = built_.size();
      built_[parent.at].split = parent.split;
      built_[parent.at].left = left;
      built_[parent.at].right = left + 1;
      built_.resize(built_.size() + 2);
      for (std::size_t side = 0; side < 2; ++side) {
        child_of[2 * n + side] = open_or_settle(2 * parent.number + static_cast<std::uint32_t>(side), left + side,
                                                child_counts_.data() + (2 * n + side) * classes_, depth);
      }
    }
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      if (node_of_[s] == kSettled) continue;
      node_of_[s] = child_of[2 * static_cast<std::size_t>(node_of_[s]) + on_right_[s]];
    }
  }

  const TrainingSet& set_;
  std::span<const TrainingSample> samples_;
  const GrowTreeOptions& options_;
  int tree_;
  GrowProgress& progress_;
  std::size_t classes_;
  LeafShares shares_;
  EntropyTable entropy_;
  std::vector<std::int32_t> node_of_;   ///< of each sample: index in `level_`
  std::vector<std::uint32_t> row_of_;   ///< of each sample
  std::vector<std::uint8_t> on_right_;  ///< side that each sample goes to
  NodeTables tables_;
  RowBlock rows_;
  std::vector<OpenNode> level_;
  std::vector<GrownNode> built_;
  std::vector<std::int64_t> child_counts_;  ///< [child * classes + class]
};

}  // namespace

void visit_options(const std::string& prefix, GrowTreeOptions& options, OptionVisitor& visitor) {
  SplitOptions& split = options.split;
  LeafOptions& leaf = options.leaf;
  visitor.option(prefix + "depth", leaf.max_depth, {"", 0, kDeepest, "Most decisions on the way to a leaf"});
  visitor.option(prefix + "seed", options.seed, {"", 0, 2147483647, "Number that all random choices follow from"});
  visitor.option(prefix + "candidates", split.candidates, {"", 1, 100000, "Pairs of offsets that a node tries"});
  visitor.option(prefix + "shared-features", split.shared_features,
                 {"", 0, 100000, "Length of one list of pairs that all nodes try; 0: every node draws its own"});
  visitor.option(prefix + "bins", split.bins, {"", 2, 32, "Intervals that the values of a pair are counted in"});
  visitor.option(prefix + "split-pixels", split.split_pixels,
                 {"", 2, EntropyTable::kLargest, "Most samples that choose the split of a node"});
  visitor.option(prefix + "max-offset", split.max_offset_m, {"m", 0.005, 10, "Furthest probe from the pixel"});
  visitor.option(prefix + "half-normal", split.half_normal,
                 {"", 0, 1, "Distances of probes half-normal, a third of the furthest being sigma; else uniform"});
  visitor.option(prefix + "one-sided", split.one_sided, {"", 0, 1, "Share of the pairs with one probe at the pixel"});
  visitor.option(prefix + "min-gain", split.min_gain, {"bits", 0, 10, "Least information that a split gains"});
  visitor.option(prefix + "min-samples", leaf.min_samples, {"", 1, 1000000, "Fewest samples of a leaf"});
  visitor.option(prefix + "prior-correction", leaf.prior_correction,
                 {"", 0, 1, "How far leaves undo what sampling did to the shares of the classes; 1: wholly"});
  visitor.option(prefix + "part-balance", leaf.part_balance,
                 {"", 0, 1, "How far leaves make up for the parts' sizes, so that small ones are seen; 1: wholly"});
}

Tree grow_tree(const TrainingSet& set, const GrowTreeOptions& options, int tree, GrowProgress* progress) {
  GrowTreeOptions checked = options;
  RangeCheck range;
  visit_options("", checked, range);
  if (set.samples().empty()) throw Error("training: no pixel with a label and a reading in any frame");
  GrowProgress unseen;
  return LevelGrower(set, checked, tree, progress != nullptr ? *progress : unseen).grow();
}

}  // namespace vesalius
