#include "cluster/reduce_task.h"

#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>

#include "cluster/message.h"
#include "cluster/train_job.h"
#include "io/files/atomic_file.h"
#include "train/growing_tree.h"
#include "train/split_candidates.h"
#include "train/split_histogram.h"

namespace vesalius {
namespace {

constexpr std::size_t kMostMerged = std::size_t{8} << 20U;  ///< bytes of a message that a combiner makes

/// Passes the records of each key to `take(key, merger)`, in the order of their first record; a merger of more than
/// `most` bytes is passed on before.
template <class Take>
void merge_keys(std::istream& in, std::size_t most, const Take& take) {
  const std::string name = "standard input";
  std::string key, line;
  KeyMerger merger;
  bool started = false;
  while (std::getline(in, line)) {
    Record record = parse_record(line, name);
    if (started && (record.key != key || merger.bytes() > most)) {
      take(key, merger);
      merger = {};
    }
    started = true;
    key = std::move(record.key);
    merger.add(record.message, fmt::format("{}: {}", name, key));
  }
  if (started) take(key, merger);
}

void expect_written(std::ostream& out) {
  out.flush();
  if (!out) throw Error("standard output: cannot be written");
}

/// Reduces the records of one job.
class ReduceTask {
 public:
  ReduceTask(const TaskContext& context, std::ostream& out)
      : out_(out),
        job_(parse_train_job(context.store.read(job_file(context.job)),
                             context.store.place() + "/" + job_file(context.job))),
        classes_(job_.forest.class_count()) {
    for (const TreeRequest& tree : job_.trees) groups_.push_back(row_groups(tree.nodes, job_.options.grow.split));
  }

  void take(const std::string& key, const KeyMerger& merged) {
    const std::string name = job_.name + ": " + key;
    switch (job_.kind) {
      case JobKind::kRows:
        return write(key, to_message(best_splits_of(key, merged.pieces(), name)));
      case JobKind::kCount:
        return write(key, to_message(totals_of(key, merged.pieces(), name)));
      case JobKind::kLeafCounts:
      case JobKind::kGradient:
        return write(key, key == kLikelihoodKey ? likelihood(merged.pieces(), name) : sums(merged.sums(), name));
      default:
        throw Error(job_.name + ": this job has no reduce tasks");
    }
  }

 private:
  void write(const std::string& key, std::string message) const { out_ << record_line({key, std::move(message)}); }

  const TreeRequest& tree_of(std::size_t tree, const std::string& name) const {
    if (tree >= job_.trees.size()) throw Error(name + ": no such tree");
    return job_.trees[tree];
  }

  std::vector<NodeReply> best_splits_of(const std::string& key, const Pieces& pieces, const std::string& name) {
    const std::vector<std::size_t> numbers = key_numbers(key, 3, name);
    const TreeRequest& tree = tree_of(numbers[0], name);
    const std::vector<NodeRange>& groups = groups_[numbers[0]];
    if (numbers[1] >= groups.size()) throw Error(name + ": no such nodes");
    const NodeRange nodes = groups[numbers[1]];
    const auto block = int(numbers[2]);
    std::vector<Part> parts;
    for (const auto& [shard, piece] : pieces) {
      parts.push_back({from_message<GroupRows>(piece, name)});
      check(parts.back().rows, nodes.size(), block_candidates(job_.options.grow.split, block), name);
    }
    std::vector<NodeReply> replies;
    for (std::int32_t n = nodes.begin; n < nodes.end; ++n) {
      for (Part& part : parts) part.node = n - nodes.begin;
      replies.push_back(best_split_of(tree, n, block, parts, name));
    }
    return replies;
  }

  /// What a shard sent of some nodes, and where the rows of the next node begin.
  struct Part {
    GroupRows rows;
    std::int32_t node = 0;
    std::size_t begin = 0;
  };

  /// Takes the rows of the next node from all parts, in the order of the shards.
  NodeReply best_split_of(const TreeRequest& tree, std::int32_t n, int block, std::vector<Part>& parts,
                          const std::string& name) {
    const LevelNode& node = tree.nodes[n];
    const SplitOptions& options = job_.options.grow.split;
    const int candidates = block_candidates(options, block);
    const int width = CandidateTable(candidates).padded;
    std::int64_t came = 0;
    for (const Part& part : parts) came += part.rows.rows[part.node];
    if (came != node.counted) {
      throw Error(
          fmt::format("{}: {} of {} samples came; the output of a map task is missing", name, came, node.counted));
    }
    labels_.clear();
    values_.assign(node.counted * width, 0);
    for (Part& part : parts) {
      const std::size_t count = part.rows.rows[part.node], first = labels_.size();
      const auto labels = part.rows.labels.begin() + static_cast<std::ptrdiff_t>(part.begin);
      labels_.insert(labels_.end(), labels, labels + static_cast<std::ptrdiff_t>(count));
      const std::size_t columns = part.begin * candidates;
      for (int c = 0; c < candidates; ++c) {
        for (std::size_t r = 0; r < count; ++r)
          values_[(first + r) * width + c] = part.rows.value(columns + c * count + r);
      }
      part.begin += count;
    }
    if (std::ranges::any_of(labels_, [&](std::uint8_t label) { return label >= classes_; })) {
      throw Error(name + ": a sample of an unknown class");
    }
    const FeatureRows rows{values_.data(), labels_.data(), labels_.size(), width};
    const int bins = bins_for(node.counted, options.bins);
    const int least = least_samples(node, job_.options.grow.leaf);
    const RowSplit split = split_of(rows, classes_, bins, candidates, least, entropy_);
    NodeReply reply{0.0, {}, std::vector<std::int64_t>(2 * classes_, 0)};
    if (split.candidate < 0 || split.threshold.gain <= 0.0) return reply;
    reply.gain = split.threshold.gain;
    reply.split = node_candidates(job_.forest.convention, job_.options.grow, tree.number, node.number, block)
                      .node(split.candidate);
    reply.split.threshold_mm = static_cast<std::int16_t>(split.threshold.threshold_mm);
    for (std::size_t r = 0; r < labels_.size(); ++r) {
      const bool right = values_[r * width + split.candidate] > reply.split.threshold_mm;
      ++reply.children[(right ? classes_ : 0) + labels_[r]];
    }
    return reply;
  }

  void expect_all_shards(std::size_t came, const std::string& name) const {
    if (came == job_.shards()) return;
    throw Error(
        fmt::format("{}: {} of {} shards came; the output of a map task is missing", name, came, job_.shards()));
  }

  CountReply totals_of(const std::string& key, const Pieces& pieces, const std::string& name) const {
    const TreeRequest& tree = tree_of(key_numbers(key, 1, name)[0], name);
    const std::size_t children = tree.large.size();
    expect_all_shards(pieces.size(), name);
    CountReply reply{std::vector<std::int64_t>(children * classes_, 0), {}};
    std::vector<std::int64_t> before(children, 0);
    for (const auto& [shard, piece] : pieces) {
      const auto counts = from_message<std::vector<std::int64_t>>(piece, name);
      if (counts.size() != reply.totals.size()) throw Error(name + ": counts of other nodes than expected");
      reply.before.insert(reply.before.end(), before.begin(), before.end());
      for (std::size_t i = 0; i < counts.size(); ++i) {
        reply.totals[i] += counts[i];
        before[i / classes_] += counts[i];
      }
    }
    return reply;
  }

  std::string sums(const Sums& sums, const std::string& name) const {
    expect_all_shards(sums.shards.size(), name);
    return to_message(sums.numbers);
  }

  /// Sums in the order of shards, so that the text for the user is the same every time.
  std::string likelihood(const Pieces& pieces, const std::string& name) const {
    expect_all_shards(pieces.size(), name);
    Likelihood all;
    for (const auto& [shard, piece] : pieces) merge(all, from_message<Likelihood>(piece, name));
    return to_message(all);
  }

  std::ostream& out_;
  TrainJob job_;
  int classes_;
  std::vector<std::vector<NodeRange>> groups_;  ///< [tree]: the nodes of each record of rows
  EntropyTable entropy_;
  std::vector<std::uint8_t> labels_;
  std::vector<std::int16_t> values_;
};

}  // namespace

void run_combine_task(std::istream& in, std::ostream& out) {
  merge_keys(in, kMostMerged, [&](const std::string& key, const KeyMerger& merged) {
    out << record_line({key, merged.message()});
  });
  expect_written(out);
}

void run_partition_task(std::istream& in, const std::string& into, int parts, bool merge) {
  std::vector<std::unique_ptr<TemporaryFile>> files;
  std::vector<std::ofstream> streams;
  for (int part = 0; part < parts; ++part) {
    files.push_back(std::make_unique<TemporaryFile>(fmt::format("{}.{}", into, part)));
    streams.emplace_back(files.back()->path(), std::ios::binary);
  }
  const auto take = [&](const std::string& key, std::string_view line) { streams[part_of(key, parts)] << line; };
  if (merge) {
    merge_keys(in, kMostMerged, [&](const std::string& key, const KeyMerger& merged) {
      take(key, record_line({key, merged.message()}));
    });
  } else {
    for (std::string line; std::getline(in, line);) take(line.substr(0, line.find('\t')), line + "\n");
  }
  for (int part = 0; part < parts; ++part) {
    streams[part].close();
    if (!streams[part]) throw Error(files[part]->final_path() + ": cannot be written");
  }
  for (const auto& file : files) file->commit();
}

int part_of(const std::string& key, int parts) {
  return int(XXH64(key.data(), key.size(), 0) % static_cast<std::uint64_t>(parts));
}

void run_reduce_task(const TaskContext& context, std::istream& in, std::ostream& out) {
  ReduceTask task(context, out);
  merge_keys(in, std::numeric_limits<std::size_t>::max(),
             [&](const std::string& key, const KeyMerger& merged) { task.take(key, merged); });
  expect_written(out);
}

}  // namespace vesalius
