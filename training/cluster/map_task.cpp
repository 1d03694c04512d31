#include "cluster/map_task.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include "cluster/message.h"
#include "cluster/train_job.h"
#include "train/feature_rows.h"
#include "train/grow_tree.h"
#include "train/leaves/leaf_shard.h"
#include "train/local_shards.h"
#include "train/parallel_in_order.h"
#include "train/samples/walk_samples.h"
#include "train/split_candidates.h"
#include "train/tree_shard.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {
namespace {

constexpr int kFramesAtATime = 1 << 20;

/// Runs the lines of one map task.
class MapTask {
 public:
  MapTask(const TaskContext& context, std::ostream& out)
      : context_(context),
        out_(out),
        name_(context.store.place() + "/" + job_file(context.job)),
        job_(parse_train_job(context.store.read(job_file(context.job)), name_)),
        layout_(job_.forest.body, job_.forest.has_background, job_.options.leaves.headings) {}

  void run(std::istream& in) {
    for (std::string line; std::getline(in, line);) {
      if (line.empty()) continue;
      const std::size_t index = parse_line(line);
      with_context(fmt::format("{} {}", job_.kind == JobKind::kSubtrees ? "subtree task" : "shard", index),
                   [&] { take(index); });
    }
    write_sums();
    out_.flush();
    if (!out_) throw Error("standard output: cannot be written");
  }

 private:
  std::size_t parse_line(const std::string& line) const {
    const std::size_t tab = line.rfind('\t');
    const char* begin = line.data() + (tab == std::string::npos ? 0 : tab + 1);
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(begin, line.data() + line.size(), index);
    const std::size_t most = job_.kind == JobKind::kSubtrees ? job_.subtrees.size() : job_.shards();
    if (error != std::errc{} || end != line.data() + line.size() || index >= most) {
      throw Error(fmt::format("standard input: {}, expected a number below {}", line, most));
    }
    return index;
  }

  void take(std::size_t index) {
    using Work = void (MapTask::*)(std::size_t);
    static constexpr Work kWork[] = {&MapTask::prepare,     &MapTask::count,       &MapTask::rows,
                                     &MapTask::subtrees,    &MapTask::hard_counts, &MapTask::harden,
                                     &MapTask::leaf_counts, &MapTask::gradient,    &MapTask::facing};  // as JobKind
    (this->*kWork[static_cast<std::size_t>(job_.kind)])(index);
    if (job_.kind != JobKind::kPrepare && job_.kind != JobKind::kSubtrees) tell("shards", 1);
  }

  void write(const std::string& key, std::string message) const { out_ << record_line({key, std::move(message)}); }

  void tell(const char* counter, std::uint64_t more) const {
    if (context_.count) context_.count(counter, more);
  }

  /// Returns the sets of shards begin to end - 1 as one.
  TrainingSet load_sets(std::size_t begin, std::size_t end) const {
    TrainingSet::Contents contents{.frames = FrameStore(job_.forest.convention)};
    for (std::size_t shard = begin; shard < end; ++shard) {
      const std::string name = set_name(job_.sets, shard);
      append_training_set(context_.store.load(name), context_.store.place() + "/" + name, contents);
    }
    return {job_.forest.body, job_.options.sample, static_cast<std::uint64_t>(job_.options.grow.seed),
            job_.first_frames[begin], std::move(contents)};
  }

  TrainingSet load_set(std::size_t shard) const { return load_sets(shard, shard + 1); }

  void prepare(std::size_t shard) {
    if (!read_frame_) read_frame_ = context_.open_source(job_.source);
    TrainingSet set(job_.forest.body, job_.forest.convention, job_.options.sample,
                    static_cast<std::uint64_t>(job_.options.grow.seed), job_.first_frames[shard]);
    const std::uint64_t first = job_.first_frames[shard], last = job_.first_frames[shard + 1];
    if (first < job_.background_frames || last - first > kFramesAtATime) throw Error("unexpected range of frames");
    parallel_in_order(
        int(last - first), [&](int i) { return read_frame_(first + i - job_.background_frames); },
        [&](int /*i*/, const LabelledFrame& frame) {
          set.add(frame);
          tell("frames", 1);
          return true;
        });
    out_ << record_line(store_set(context_.store, job_, set, shard, 0));
  }

  /// Returns [tree][sample]: the leaf of each sample in the open trees.
  std::vector<std::vector<std::uint32_t>> open_leaves(const TrainingSet& set) const {
    std::vector<const Tree*> trees;
    for (const TreeRequest& tree : job_.trees) trees.push_back(&tree.open.tree);
    return find_leaves(trees, set.frames(), set.samples());
  }

  void count(std::size_t shard) {
    const TrainingSet set = load_set(shard);
    const auto leaves = open_leaves(set);
    for (std::size_t t = 0; t < job_.trees.size(); ++t) {
      const TreeRequest& tree = job_.trees[t];
      const ChildCounts all = TreeShard(set, job_.options.grow, tree.number).move_to(tree.open, leaves[t]);
      std::vector<std::int64_t> counts;
      for (const std::int32_t child : tree.large)
        counts.insert(counts.end(), all.of(child), all.of(child) + all.classes);
      write(tree_key(t), piece_message(static_cast<std::uint32_t>(shard), to_message(counts)));
    }
  }

  void rows(std::size_t shard) {
    const TrainingSet set = load_set(shard);
    const auto leaves = open_leaves(set);
    for (std::size_t t = 0; t < job_.trees.size(); ++t) rows_of_tree(shard, set, t, leaves[t]);
  }

  void rows_of_tree(std::size_t shard, const TrainingSet& set, std::size_t t, std::span<const std::uint32_t> leaves) {
    const TreeRequest& request = job_.trees[t];
    TreeShard tree(set, job_.options.grow, request.number);
    const ChildSizes own = child_sizes(tree.move_to(request.open, leaves));
    const auto nodes = static_cast<std::int32_t>(request.nodes.size());
    Level level{{}, request.nodes};
    for (std::int32_t n = 0; n < nodes; ++n) level.node_of_child.push_back(n);
    ChildSizes before(nodes, 0);
    for (std::size_t i = 0; i < request.large.size(); ++i) {
      before[request.large[i]] = request.before[shard * request.large.size() + i];
    }
    tree.open_level(level, before);
    const std::vector<NodeRange> groups = row_groups(request.nodes, job_.options.grow.split);
    const auto bytes_of = [&](std::int32_t g) {
      std::int64_t rows = 0;
      for (std::int32_t n = groups[g].begin; n < groups[g].end; ++n) rows += std::min(own[n], request.nodes[n].counted);
      return rows * static_cast<std::int64_t>(sizeof(std::int16_t) * kBlockCandidates);
    };
    for (const NodeRange& run : node_runs({0, static_cast<std::int32_t>(groups.size())},
                                          static_cast<std::int64_t>(context_.row_bytes), bytes_of)) {
      for (int block = 0; block < candidate_blocks(job_.options.grow.split); ++block) {
        tree.evaluate({groups[run.begin].begin, groups[run.end - 1].end}, block);
        write_rows(shard, tree, t, {groups.data() + run.begin, groups.data() + run.end}, run.begin, block);
      }
    }
  }

  /// Writes the rows that were evaluated last, whose groups begin with number `first` of tree `t`.
  void write_rows(std::size_t shard, const TreeShard& tree, std::size_t t, std::span<const NodeRange> groups, int first,
                  int block) {
    std::vector<std::string> lines(groups.size());
    parallel_for(int(groups.size()), [&](int i) {
      const GroupRows rows = rows_of(tree, groups[i], block_candidates(job_.options.grow.split, block));
      if (rows.labels.empty()) return;
      lines[i] = record_line(
          {node_key(t, first + i, block), piece_message(static_cast<std::uint32_t>(shard), to_message(rows))});
    });
    std::uint64_t evaluations = 0;
    for (const std::string& line : lines) out_ << line;
    for (std::int32_t n = groups.front().begin; n < groups.back().end; ++n) {
      evaluations += tree.rows(n).rows * block_candidates(job_.options.grow.split, block);
    }
    tell("evaluations", evaluations);
  }

  static GroupRows rows_of(const TreeShard& tree, NodeRange nodes, int candidates) {
    GroupRows group;
    for (std::int32_t n = nodes.begin; n < nodes.end; ++n) {
      const FeatureRows rows = tree.rows(n);
      group.rows.push_back(static_cast<std::uint32_t>(rows.rows));
      group.labels.insert(group.labels.end(), rows.labels, rows.labels + rows.rows);
    }
    group.low.resize(group.labels.size() * candidates);
    group.high.resize(group.low.size());
    std::size_t at = 0;
    for (std::int32_t n = nodes.begin; n < nodes.end; ++n) {
      const FeatureRows rows = tree.rows(n);
      for (std::size_t r = 0; r < rows.rows; ++r) {
        for (int c = 0; c < candidates; ++c) {
          const auto value = static_cast<std::uint16_t>(rows.values[r * rows.width + c]);
          group.low[at + c * rows.rows + r] = static_cast<std::uint8_t>(value);
          group.high[at + c * rows.rows + r] = static_cast<std::uint8_t>(value >> 8U);
        }
      }
      at += rows.rows * candidates;
    }
    return group;
  }

  void subtrees(std::size_t index) {
    if (!all_) all_.emplace(load_sets(0, job_.shards()));
    const SubtreeRequest& request = job_.subtrees[index];
    const TreeRequest& tree = job_.trees.at(request.tree);
    OpenTree open = tree.open;
    std::vector<std::int32_t> root_of(open.children, kSettled);
    std::vector<TreeRoot> roots;
    for (std::size_t i = 0; i < request.nodes.size(); ++i) {
      root_of.at(request.nodes[i]) = static_cast<std::int32_t>(i);
      roots.push_back({tree.nodes.at(request.nodes[i]).number, request.counts.at(i)});
    }
    for (std::int32_t& child : open.child_of_leaf) child = child == kSettled ? kSettled : root_of.at(child);
    open.children = roots.size();
    LocalTree shards({&*all_}, job_.options.grow, tree.number);
    shards.walk_to(open);
    GrowProgress progress;
    const auto grown =
        grow_subtrees(shards, job_.forest, job_.options.grow, tree.number, job_.samples, roots, progress);
    for (std::size_t i = 0; i < roots.size(); ++i)
      write(node_key(request.tree, request.nodes[i], 0), to_message(grown[i]));
    tell("evaluations", progress.evaluations);
  }

  void hard_counts(std::size_t shard) {
    TrainingSet set = load_set(shard);
    write(shard_key(shard), to_message(set.count_hard_negatives(job_.forest)));
  }

  void harden(std::size_t shard) {
    TrainingSet set = load_set(shard);
    set.count_hard_negatives(job_.forest);
    const std::size_t added = set.add_hard_negatives(job_.cuts.at(shard));
    out_ << record_line(store_set(context_.store, job_, set, shard, added));
  }

  void leaf_counts(std::size_t shard) {
    const TrainingSet set = load_set(shard);
    LeafShard leaves(set, job_.forest, layout_);
    leaves.set_weights(job_.weights);
    for (std::size_t t = 0; t < job_.forest.trees.size(); ++t) {
      add_sums(t, leaves.leaf_counts(int(t)).weights);
    }
    summed_shards_.push_back(static_cast<std::uint32_t>(shard));
  }

  void gradient(std::size_t shard) {
    const TrainingSet set = load_set(shard);
    LeafShard leaves(set, job_.forest, layout_, job_.gradient);
    leaves.set_weights(job_.weights);
    const LeafGradient gradient = leaves.gradient(job_.logits, job_.gradient);
    for (std::size_t t = 0; t < gradient.of_trees.size(); ++t) add_sums(t, gradient.of_trees[t]);
    const std::string likelihood = to_message(Likelihood{gradient.log_likelihood, gradient.weight});
    write(kLikelihoodKey, piece_message(static_cast<std::uint32_t>(shard), likelihood));
    summed_shards_.push_back(static_cast<std::uint32_t>(shard));
  }

  /// Adds a shard's numbers to those of the other shards of this task, so that each task writes them once.
  template <class Number>
  void add_sums(std::size_t tree, const std::vector<Number>& numbers) {
    if (sums_.size() <= tree) sums_.resize(tree + 1);
    sums_[tree].resize(numbers.size(), 0);
    for (std::size_t i = 0; i < numbers.size(); ++i) sums_[tree][i] += numbers[i];
  }

  void write_sums() {
    std::ranges::sort(summed_shards_);
    const std::size_t row = job_.kind == JobKind::kGradient ? job_.logits.stride : layout_.size();
    for (std::size_t t = 0; t < sums_.size(); ++t) {
      const std::size_t block = kLeafBlock * row;
      for (std::size_t begin = 0; begin < sums_[t].size(); begin += block) {
        const std::size_t end = std::min(begin + block, sums_[t].size());
        write(node_key(t, begin / block, 0),
              sums_message({summed_shards_, {sums_[t].begin() + begin, sums_[t].begin() + end}}));
      }
    }
  }

  void facing(std::size_t shard) { write(shard_key(shard), to_message(facing_samples(load_set(shard), job_.forest))); }

  const TaskContext& context_;
  std::ostream& out_;
  std::string name_;
  TrainJob job_;
  LogitLayout layout_;
  TaskContext::ReadFrame read_frame_;
  std::optional<TrainingSet> all_;               ///< the sets of all shards as one
  std::vector<std::vector<std::int64_t>> sums_;  ///< [tree]
  std::vector<std::uint32_t> summed_shards_;
};

constexpr std::uint32_t kMagic = 0x53545356;  // "VSTS"
constexpr std::uint32_t kVersion = 3;

/// Returns how many bytes after byte `at` the next multiple of a cache line is.
std::size_t to_line(std::size_t at) { return (kLineBytes - at % kLineBytes) % kLineBytes; }

/// A frame whose depth stands behind the message.
struct FrameHeader {
  Camera camera;
  std::uint64_t words = 0;

  static void visit_fields(auto&& visit, auto&... of) { visit("camera", of.camera...)("words", of.words...); }
};

}  // namespace

void run_map_task(const TaskContext& context, std::istream& in, std::ostream& out) { MapTask(context, out).run(in); }

Record store_set(Store& store, const TrainJob& job, const TrainingSet& set, std::size_t shard, std::uint64_t hard) {
  const std::string bytes = training_set_bytes(set);
  store.write(set_name(job.new_sets, shard), bytes);
  const LogitLayout layout(job.forest.body, job.forest.has_background, job.options.leaves.headings);
  Forest without_trees = job.forest;
  without_trees.trees.clear();
  PreparedShard prepared{set.sample_counts(),   LeafShard(set, without_trees, layout).label_counts(),
                         set.frames().size(),   bytes.size(),
                         set.held_out().size(), hard};
  return {shard_key(shard), to_message(prepared)};
}

std::string training_set_bytes(const TrainingSet& set) {
  const TrainingSet::Contents& contents = set.contents();
  std::vector<FrameHeader> frames;
  for (std::size_t f = 0; f < contents.frames.size(); ++f) {
    frames.push_back({contents.frames.camera(f), contents.frames.words(f).size()});
  }
  MessageWriter out;
  std::string& bytes = out.bytes();
  bytes.reserve(set.bytes() + set.bytes() / 64);
  for (const std::uint32_t number : {kMagic, kVersion}) out.number(number);
  out.number(std::uint64_t{0});  // the checksum's place
  const std::size_t header = bytes.size();
  out("contents", contents);
  out("frames", frames);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::span<const std::uint32_t> words = contents.frames.words(f);
    bytes.append(to_line(bytes.size()), '\0');
    bytes.append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
  }
  const auto checksum = static_cast<std::uint64_t>(XXH64(bytes.data() + header, bytes.size() - header, 0));
  std::memcpy(bytes.data() + header - sizeof(checksum), &checksum, sizeof(checksum));
  return std::move(bytes);
}

void append_training_set(HugeBuffer buffer, const std::string& name, TrainingSet::Contents& contents) {
  const std::string_view bytes(reinterpret_cast<const char*>(buffer.data()), buffer.size());
  MessageReader in(bytes, name);
  if (in.number<std::uint32_t>("the mark of a shard") != kMagic)
    throw Error(name + ": no shard of a training; --restart makes all shards anew");
  if (const auto version = in.number<std::uint32_t>("version"); version != kVersion) {
    throw Error(fmt::format("{}: shard of version {}, expected {}", name, version, kVersion));
  }
  const auto checksum = in.number<std::uint64_t>("checksum");
  const std::string_view rest = bytes.substr(bytes.size() - in.left());
  if (checksum != XXH64(rest.data(), rest.size(), 0)) {
    throw Error(name + ": damaged, its checksum does not match; --restart makes all shards anew");
  }
  TrainingSet::Contents more{.frames = FrameStore(contents.frames.convention())};
  std::vector<FrameHeader> frames;
  in("contents", more);
  in("frames", frames);
  std::vector<FrameStore::InBlock> blocks;
  for (const FrameHeader& frame : frames) {
    in.take(to_line(bytes.size() - in.left()), "zeros before depth");
    blocks.push_back({frame.camera, bytes.size() - in.left(), frame.words});
    if (frame.words > in.left() / sizeof(std::uint32_t)) in.fail(fmt::format("{} words of depth", frame.words));
    in.take(frame.words * sizeof(std::uint32_t), "depth");
  }
  in.expect_end();

  const auto first_frame = static_cast<std::uint32_t>(contents.frames.size());
  const auto first_person = static_cast<std::uint32_t>(contents.people_samples.size());
  for (auto samples : {&TrainingSet::Contents::samples, &TrainingSet::Contents::pool, &TrainingSet::Contents::held_out,
                       &TrainingSet::Contents::people_samples}) {
    for (TrainingSample& sample : more.*samples) sample.frame += first_frame;
    (contents.*samples).insert((contents.*samples).end(), (more.*samples).begin(), (more.*samples).end());
  }
  for (const PersonSamples& person : more.people) {
    contents.people.push_back({person.heading, person.begin + first_person, person.end + first_person});
  }
  contents.class_pixels.resize(std::max(contents.class_pixels.size(), more.class_pixels.size()), 0);
  for (std::size_t k = 0; k < more.class_pixels.size(); ++k) contents.class_pixels[k] += more.class_pixels[k];
  contents.frames.add_block(std::move(buffer), blocks);
}

}  // namespace vesalius
