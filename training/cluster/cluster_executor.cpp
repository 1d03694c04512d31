#include "cluster/cluster_executor.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <utility>

#include "cluster/map_task.h"
#include "cluster/message.h"
#include "train/grow_tree.h"
#include "train/leaves/leaf_shard.h"
#include "train/local_shards.h"
#include "train/split_candidates.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

std::vector<std::size_t> up_to(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

/// Returns the bytes under a key. Throws Error if a job did not write it.
const std::string& bytes_of(const std::map<std::string, std::string>& records, const std::string& key,
                            const std::string& job) {
  const auto found = records.find(key);
  if (found == records.end()) throw Error(fmt::format("{}: no result for {}", job, key));
  return found->second;
}

/// Returns the message under a key. Throws Error as well if it is damaged.
template <class T>
T message_of(const std::map<std::string, std::string>& records, const std::string& key, const std::string& job) {
  return from_message<T>(bytes_of(records, key, job), job + ": " + key);
}

/// Returns the nodes of a subtree. Throws Error naming `name` as well if a child is beyond the last one.
std::vector<GrownNode> parse_grown_nodes(std::string_view message, const std::string& name) {
  auto nodes = from_message<std::vector<GrownNode>>(message, name);
  const auto is_inside = [&](const GrownNode& node) { return std::max(node.left, node.right) < nodes.size(); };
  if (nodes.empty() || !std::ranges::all_of(nodes, is_inside)) throw Error(name + ": child beyond the last node");
  return nodes;
}

}  // namespace

/// The leaves in learning.
class ClusterLeaves : public LeafExecutor {
 public:
  ClusterLeaves(ClusterExecutor& all, const Forest& forest, LogitLayout layout)
      : all_(all), forest_(forest), layout_(std::move(layout)) {}

  LabelCounts label_counts() override { return all_.total().labels; }

  void set_weights(const SampleWeights& weights) override { weights_ = weights; }

  LeafCounts leaf_counts(int tree) override {
    if (counts_.empty()) {
      TrainJob job = all_.new_job(JobKind::kLeafCounts, "leaf-counts");
      job.forest = forest_;
      job.weights = weights_;
      counts_ = sums_of_trees(all_.run_over_shards(job, true), job.name, layout_.size());
    }
    return {std::move(counts_[tree])};
  }

  LeafGradient gradient(const LeafLogits& logits, const GradientTask& task) override {
    TrainJob job = all_.new_job(JobKind::kGradient, fmt::format("gradient-{:04}", round_++));
    job.forest = forest_;
    job.weights = weights_;
    job.logits = logits;
    job.gradient = task;
    const ClusterExecutor::Records records = all_.run_over_shards(job, true);
    LeafGradient gradient;
    for (const std::vector<std::int64_t>& sums : sums_of_trees(records, job.name, logits.stride)) {
      gradient.of_trees.emplace_back(sums.begin(), sums.end());
    }
    const auto likelihood = message_of<Likelihood>(records, kLikelihoodKey, job.name);
    gradient.log_likelihood = likelihood.log_likelihood;
    gradient.weight = likelihood.weight;
    // The logits are kept elsewhere, and a round's result is large.
    if (!last_.empty()) all_.engine_.store().remove(job_folder(last_));
    last_ = job.name;
    return gradient;
  }

 private:
  /// Puts the blocks of all trees together, whose leaves have `row` numbers each.
  std::vector<std::vector<std::int64_t>> sums_of_trees(const ClusterExecutor::Records& records, const std::string& job,
                                                       std::size_t row) const {
    std::vector<std::vector<std::int64_t>> all;
    for (std::size_t t = 0; t < forest_.trees.size(); ++t) {
      std::vector<std::int64_t>& sums = all.emplace_back();
      const std::size_t size = forest_.trees[t].leaves.size() * row;
      for (std::size_t block = 0; sums.size() < size; ++block) {
        const auto numbers = message_of<std::vector<std::int64_t>>(records, node_key(t, block, 0), job);
        sums.insert(sums.end(), numbers.begin(), numbers.end());
        if (numbers.empty() || sums.size() > size) throw Error(job + ": sums of other leaves than expected");
      }
    }
    return all;
  }

  ClusterExecutor& all_;
  const Forest& forest_;
  LogitLayout layout_;
  SampleWeights weights_;
  std::vector<std::vector<std::int64_t>> counts_;
  int round_ = 0;
  std::string last_;  ///< name of the last gradient's job
};

/// Trees that grow together.
class ClusterExecutor::Round {
 public:
  Round(ClusterExecutor& all, const std::vector<int>& numbers, GrowProgress& progress)
      : all_(all), options_(all.training_.options.grow), samples_(all.total().samples), progress_(progress) {
    if (std::ranges::all_of(samples_.samples, [](std::int64_t n) { return n == 0; })) {
      throw Error("training: no pixel with a label and a reading in any frame");
    }
    for (const int number : numbers) {
      State& state = states_.emplace_back(
          State{number, GrowingTree(samples_, all.training_.forest.body.part_count(), options_), {}, {}, {}, {}});
      const TreeRoot root{1, samples_.samples};
      state.grown.begin({&root, 1});
      state.counts = {samples_.samples};
      state.large = large_nodes(state.grown);
      if (!state.large.empty()) {
        std::int64_t before = 0;
        for (const PreparedShard& shard : all.prepared_) {
          state.before.push_back(before);
          before = std::accumulate(shard.samples.samples.begin(), shard.samples.samples.end(), before);
        }
      }
    }
  }

  void run(const TakeTree& take) {
    const std::string name = fmt::format("trees-{:04}", states_.front().number);
    for (int level = 0; open(); ++level) {
      if (progress_.stop) throw Interrupted("training: interrupted");
      const std::string of_level = fmt::format("{}-level-{:02}", name, level);
      if (const std::vector<SubtreeRequest> tasks = subtree_tasks(); !tasks.empty()) {
        grow_subtrees(tasks, of_level + "-subtrees");
      } else {
        split_level(of_level + "-rows");
        descend(of_level + "-counts");
      }
      tell_progress();
    }
    for (State& state : states_) take(state.number, pruned_tree(state.grown.nodes()));
  }

 private:
  struct State {
    int number = 0;
    GrowingTree grown;
    std::vector<std::vector<std::int64_t>> counts;  ///< [node of the level][class]
    std::vector<std::int32_t> large;                ///< nodes of the level that have ranks
    std::vector<std::int64_t> before;               ///< [shard * large.size() + index in large]
    std::vector<NodeReply> replies;                 ///< [node of the level]: the best
  };

  std::vector<std::int32_t> large_nodes(const GrowingTree& grown) const {
    std::vector<std::int32_t> large;
    for (std::size_t n = 0; n < grown.level().size(); ++n) {
      const LevelNode& node = grown.level()[n].node;
      if (node.counted < node.size) large.push_back(static_cast<std::int32_t>(n));
    }
    return large;
  }

  bool open() const {
    return std::ranges::any_of(states_, [](const State& state) { return !state.grown.level().empty(); });
  }

  TreeRequest request_of(const State& state) const {
    TreeRequest request{state.number, state.grown.open_level(), {}, state.large, state.before};
    for (const OpenNode& open : state.grown.level()) request.nodes.push_back(open.node);
    return request;
  }

  /// Finds the best splits of all nodes of the level.
  void split_level(const std::string& name) {
    TrainJob job = all_.new_job(JobKind::kRows, name);
    for (const State& state : states_) job.trees.push_back(request_of(state));
    const Records records = all_.run_over_shards(job, true);
    const auto blocks = static_cast<std::size_t>(candidate_blocks(options_.split));
    for (std::size_t t = 0; t < states_.size(); ++t) {
      State& state = states_[t];
      state.replies.assign(state.grown.level().size(), {});
      const std::vector<NodeRange> groups = row_groups(job.trees[t].nodes, options_.split);
      for (std::size_t g = 0; g < groups.size(); ++g) {
        for (std::size_t block = 0; block < blocks; ++block) {
          auto replies = message_of<std::vector<NodeReply>>(records, node_key(t, g, block), name);
          if (std::ssize(replies) != groups[g].size()) throw Error(name + ": splits of other nodes than expected");
          for (std::int32_t n = groups[g].begin; n < groups[g].end; ++n) {
            NodeReply& reply = replies[n - groups[g].begin];
            const auto counted = static_cast<std::uint64_t>(job.trees[t].nodes[n].counted);
            progress_.evaluations += counted * block_candidates(options_.split, int(block));
            if (state.grown.offer(n, reply.split, reply.gain)) state.replies[n] = std::move(reply);
          }
        }
      }
    }
  }

  /// Makes the next level. The rows have counted the children of small nodes; those of large ones are counted by a job.
  void descend(const std::string& name) {
    TrainJob job = all_.new_job(JobKind::kCount, name);
    bool needed = false;
    for (const State& state : states_) {
      TreeRequest request{state.number, state.grown.open_children(), {}, {}, {}};
      for (const std::int32_t n : state.large) {
        if (state.grown.level()[n].gain > 0.0) request.large.insert(request.large.end(), {2 * n, 2 * n + 1});
      }
      needed = needed || !request.large.empty();
      job.trees.push_back(std::move(request));
    }
    Records records;
    if (needed) records = all_.run_over_shards(job, true);
    for (std::size_t t = 0; t < states_.size(); ++t) {
      CountReply reply;
      if (needed) reply = message_of<CountReply>(records, tree_key(t), name);
      descend(states_[t], job.trees[t].large, reply, name);
    }
  }

  void descend(State& state, const std::vector<std::int32_t>& counted, const CountReply& reply,
               const std::string& name) const {
    const std::size_t classes = samples_.samples.size();
    ChildCounts children{static_cast<std::int32_t>(classes), {}};
    for (const NodeReply& node : state.replies) {
      if (node.children.empty()) {
        children.counts.resize(children.counts.size() + 2 * classes, 0);
      } else if (node.children.size() == 2 * classes) {
        children.counts.insert(children.counts.end(), node.children.begin(), node.children.end());
      } else {
        throw Error(name + ": counts of other classes than expected");
      }
    }
    if (reply.totals.size() != counted.size() * classes || reply.before.size() != counted.size() * all_.shards()) {
      if (!counted.empty()) throw Error(name + ": counts of other nodes than expected");
    }
    for (std::size_t i = 0; i < counted.size(); ++i) {
      std::copy_n(reply.totals.data() + i * classes, classes, children.counts.data() + counted[i] * classes);
    }
    const std::vector<std::int32_t> node_of_child = state.grown.descend(children);
    state.counts.assign(state.grown.level().size(), {});
    for (std::size_t child = 0; child < node_of_child.size(); ++child) {
      if (node_of_child[child] == kSettled) continue;
      state.counts[node_of_child[child]].assign(children.of(child), children.of(child) + classes);
    }
    state.large = large_nodes(state.grown);
    std::vector<std::size_t> column(state.grown.level().size(), 0);
    for (std::size_t i = 0; i < counted.size(); ++i) {
      if (node_of_child[counted[i]] != kSettled) column[node_of_child[counted[i]]] = i;
    }
    state.before.clear();
    for (std::size_t s = 0; s < all_.shards(); ++s) {
      for (const std::int32_t n : state.large) state.before.push_back(reply.before[s * counted.size() + column[n]]);
    }
  }

  /// Divides the subtrees of all open nodes among tasks, the largest first, if a task's memory holds all sets and no
  /// node is so large that the tasks would wait for it. Otherwise returns nothing.
  std::vector<SubtreeRequest> subtree_tasks() const {
    if (all_.total().bytes > all_.plan_.task_memory) return {};
    const auto work_of = [&](const OpenNode& open) {
      return double(open.node.size) * (options_.leaf.max_depth - depth_of(open.node.number));
    };
    double work = 0.0, largest = 0.0;
    for (const State& state : states_) {
      for (const OpenNode& open : state.grown.level()) {
        work += work_of(open);
        largest = std::max(largest, work_of(open));
      }
    }
    const double share = work / std::max(1, all_.plan_.map_tasks);
    if (largest > share * kLargestShare) return {};
    std::vector<std::pair<double, SubtreeRequest>> tasks;
    for (std::size_t t = 0; t < states_.size(); ++t) {
      const std::vector<OpenNode>& level = states_[t].grown.level();
      for (std::size_t n = 0; n < level.size(); ++n) {
        if (n == 0 || tasks.back().first + work_of(level[n]) > share / kTasksOfShare) {
          tasks.push_back({0.0, {static_cast<std::int32_t>(t), {}}});
        }
        tasks.back().first += work_of(level[n]);
        tasks.back().second.nodes.push_back(static_cast<std::int32_t>(n));
      }
    }
    std::ranges::stable_sort(tasks, [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<SubtreeRequest> requests;
    requests.reserve(tasks.size());
    for (auto& task : tasks) requests.push_back(std::move(task.second));
    return requests;
  }

  void grow_subtrees(const std::vector<SubtreeRequest>& tasks, const std::string& name) {
    TrainJob job = all_.new_job(JobKind::kSubtrees, name);
    job.samples = samples_;
    for (State& state : states_) {
      TreeRequest request = request_of(state);
      request.large.clear();
      request.before.clear();
      job.trees.push_back(std::move(request));
    }
    job.subtrees = tasks;
    for (SubtreeRequest& task : job.subtrees) {
      for (const std::int32_t n : task.nodes) task.counts.push_back(states_[task.tree].counts[n]);
    }
    const Records records = all_.run(job, up_to(tasks.size()), false);
    for (const SubtreeRequest& task : tasks) {
      for (const std::int32_t n : task.nodes) {
        const std::string key = node_key(task.tree, n, 0);
        states_[task.tree].grown.graft(
            n, parse_grown_nodes(bytes_of(records, key, name), fmt::format("{}: {}", name, key)));
      }
    }
    for (State& state : states_) state.grown.close();
  }

  void tell_progress() {
    std::int64_t settled = 0, nodes = 0;
    for (const State& state : states_) {
      settled += state.grown.settled();
      nodes += state.grown.split_nodes();
    }
    progress_.settled = static_cast<std::uint64_t>(settled);
    progress_.nodes = static_cast<std::uint64_t>(nodes);
  }

  /// A node may be so much larger than a task's share of the work before tasks wait for it.
  static constexpr double kLargestShare = 1.2;
  /// Subtree tasks in a task's share, so that fast machines take more of them.
  static constexpr double kTasksOfShare = 2.0;

  ClusterExecutor& all_;
  const GrowTreeOptions& options_;
  SampleCounts samples_;
  GrowProgress& progress_;
  std::vector<State> states_;
};

ClusterExecutor::ClusterExecutor(Engine& engine, ClusterTraining training, const ClusterPlan& plan)
    : engine_(engine), training_(std::move(training)), plan_(plan), first_frames_{0} {
  for (const TrainingSet* set : training_.backgrounds) {
    first_frames_.push_back(first_frames_.back() + set->frames().size());
  }
  const std::uint64_t behind = first_frames_.back(), end = behind + training_.frames;
  while (first_frames_.back() < end) first_frames_.push_back(std::min(first_frames_.back() + plan.shard_frames, end));
  TrainJob job = new_job(JobKind::kPrepare, "prepare");
  job.source = training_.source;
  job.new_sets = sets_;
  job.background_frames = behind;
  prepared_.resize(shards());
  const std::size_t own = training_.backgrounds.size();
  for (std::size_t s = 0; s < own; ++s) {
    const Record record = store_set(engine_.store(), job, *training_.backgrounds[s], s, 0);
    prepared_[s] = from_message<PreparedShard>(record.message, job.name);
  }
  std::vector<std::size_t> lines = up_to(shards());
  lines.erase(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(own));
  take_prepared(run(job, lines, false), job.name);
}

TrainJob ClusterExecutor::new_job(JobKind kind, const std::string& name) const {
  TrainJob job;
  job.kind = kind;
  job.name = name;
  job.forest = training_.forest;
  job.options = training_.options;
  job.sets = sets_;
  job.first_frames = first_frames_;
  return job;
}

ClusterExecutor::Records ClusterExecutor::run_over_shards(const TrainJob& job, bool reduced) {
  return run(job, up_to(shards()), reduced);
}

ClusterExecutor::Records ClusterExecutor::run(const TrainJob& job, const std::vector<std::size_t>& lines,
                                              bool reduced) {
  Store& store = engine_.store();
  const std::string bytes = serialise(job);
  const bool known = store.exists(job_file(job.name)) && store.read(job_file(job.name)) == bytes;
  if (!known) {
    engine_.remove(job.name);
    store.write(job_file(job.name), bytes);
  }
  if (!known || !store.exists(result_folder(job.name) + "/_SUCCESS")) {
    EngineJob request;
    request.name = job.name;
    request.reduced = reduced;
    request.summed = job.kind == JobKind::kLeafCounts || job.kind == JobKind::kGradient;
    for (const std::size_t line : lines) request.lines.push_back(std::to_string(line));
    engine_.run(request);
  }
  return results(job.name);
}

ClusterExecutor::Records ClusterExecutor::results(const std::string& job) const {
  const Store& store = engine_.store();
  Records records;
  for (const std::string& file : store.list(result_folder(job))) {
    if (!file.starts_with("part-")) continue;
    const std::string name = result_folder(job) + "/" + file;
    std::istringstream lines(store.read(name));
    for (std::string line; std::getline(lines, line);) {
      Record record = parse_record(line, store.place() + "/" + name);
      const auto [at, fresh] = records.try_emplace(std::move(record.key), std::move(record.message));
      if (!fresh && at->second != record.message) throw Error(fmt::format("{}: two results for {}", name, at->first));
    }
  }
  return records;
}

void ClusterExecutor::take_prepared(const Records& records, const std::string& job) {
  for (const auto& [key, message] : records) {
    const std::size_t shard = key_numbers(key, 1, job)[0];
    if (shard >= shards()) throw Error(fmt::format("{}: unexpected result for {}", job, key));
    prepared_[shard] = from_message<PreparedShard>(message, job);
  }
  for (std::size_t s = 0; s < shards(); ++s) {
    if (prepared_[s].frames != first_frames_[s + 1] - first_frames_[s]) {
      throw Error(fmt::format("{}: no result for shard {}", job, s));
    }
  }
}

PreparedShard ClusterExecutor::total() const {
  return merged(prepared_, [](const PreparedShard& shard) { return shard; });
}

void ClusterExecutor::grow_trees(const Forest& /*forest*/, const GrowTreeOptions& /*options*/,
                                 const std::vector<int>& numbers, GrowProgress& progress, const TakeTree& take) {
  Round(*this, numbers, progress).run(take);
}

HardCounts ClusterExecutor::count_hard_negatives(const Forest& forest) {
  TrainJob job = new_job(JobKind::kHardCounts, "hard-counts");
  job.forest = forest;
  hard_forest_ = forest;
  const Records records = run_over_shards(job, false);
  hard_.clear();
  for (std::size_t s = 0; s < shards(); ++s) hard_.push_back(message_of<HardCounts>(records, shard_key(s), job.name));
  return merged(hard_, [](const HardCounts& counts) { return counts; });
}

std::size_t ClusterExecutor::add_hard_negatives(const HardCut& cut) {
  TrainJob job = new_job(JobKind::kHarden, "harden");
  job.forest = hard_forest_;
  job.new_sets = "sets-1";
  HardCut rest = cut;
  for (const HardCounts& own : hard_) job.cuts.push_back(take_part(rest, own));
  take_prepared(run_over_shards(job, false), job.name);
  sets_ = job.new_sets;
  return total().hard_negatives;
}

std::unique_ptr<LeafExecutor> ClusterExecutor::begin_leaves(const Forest& forest, const LogitLayout& layout) {
  return std::make_unique<ClusterLeaves>(*this, forest, layout);
}

std::vector<FacingSample> ClusterExecutor::facing_samples(const Forest& forest) {
  TrainJob job = new_job(JobKind::kFacing, "facing");
  job.forest = forest;
  const Records records = run_over_shards(job, false);
  std::vector<FacingSample> all;
  for (std::size_t s = 0; s < shards(); ++s) {
    std::ranges::move(message_of<std::vector<FacingSample>>(records, shard_key(s), job.name), std::back_inserter(all));
  }
  return all;
}

void ClusterExecutor::clear(Engine& engine) {
  Store& store = engine.store();
  for (const std::string& job : store.list("jobs")) engine.remove(job);
  for (const char* folder : {"jobs", "sets-0", "sets-1"}) store.remove(folder);
}

}  // namespace vesalius
