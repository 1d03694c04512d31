#include "cluster/train_job.h"

#include <utility>

#include "cluster/message.h"
#include "io/files/options_file.h"
#include "io/model/model_trees.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {
namespace {

constexpr auto kLastKind = static_cast<std::uint8_t>(JobKind::kFacing);
constexpr std::uint32_t kMostParts = 1U << 20U;  ///< of a list that is read one by one

std::string toml_of(TrainOptions options) {
  return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
}

void write_forest(MessageWriter& out, const Forest& forest) {
  out.text(forest.body.toml);
  const FeatureConvention& convention = forest.convention;
  out.real(convention.offset_unit);
  out.real(convention.reference_focal_px);
  for (const std::uint16_t mm : {convention.hole_mm, convention.outside_mm, convention.clip_mm}) out.number(mm);
  out.number(static_cast<std::uint8_t>(forest.has_background));
  write_trees(out, forest.trees);
  out.number(static_cast<std::uint32_t>(forest.headings));
  out.real(forest.logit_unit);
  for (const Tree& tree : forest.trees) out.array(tree.logits);
}

Forest read_forest(MessageReader& in) {
  Forest forest;
  forest.body = parse_body_model(in.text("body"), in.name());
  FeatureConvention& convention = forest.convention;
  convention.offset_unit = in.real32("offset unit");
  convention.reference_focal_px = in.real32("focal length");
  for (std::uint16_t* mm : {&convention.hole_mm, &convention.outside_mm, &convention.clip_mm}) {
    *mm = in.number<std::uint16_t>("convention");
  }
  forest.has_background = in.number<std::uint8_t>("background") != 0;
  forest.trees = read_trees(in);
  forest.headings = static_cast<int>(in.number<std::uint32_t>("headings"));
  forest.logit_unit = in.real32("unit of logits");
  for (Tree& tree : forest.trees) tree.logits = in.array<std::int8_t>("logits");
  return forest;
}

void write_node(MessageWriter& out, const TreeNode& node) {
  for (const std::int16_t number : {node.du1, node.dv1, node.du2, node.dv2, node.threshold_mm}) {
    out.number(static_cast<std::uint16_t>(number));
  }
  for (const std::int32_t child : {node.left, node.right}) out.number(static_cast<std::uint32_t>(child));
}

TreeNode read_node(MessageReader& in) {
  TreeNode node;
  for (std::int16_t* number : {&node.du1, &node.dv1, &node.du2, &node.dv2, &node.threshold_mm}) {
    *number = static_cast<std::int16_t>(in.number<std::uint16_t>("node"));
  }
  for (std::int32_t* child : {&node.left, &node.right}) {
    *child = static_cast<std::int32_t>(in.number<std::uint32_t>("child"));
  }
  return node;
}

void write_tree(MessageWriter& out, const TreeRequest& tree) {
  out.number(static_cast<std::uint32_t>(tree.number));
  out.number(static_cast<std::uint64_t>(tree.open.tree.nodes.size()));
  for (const TreeNode& node : tree.open.tree.nodes) write_node(out, node);
  out.array(tree.open.child_of_leaf);
  out.number(static_cast<std::uint64_t>(tree.open.children));
  out.number(static_cast<std::uint64_t>(tree.nodes.size()));
  for (const LevelNode& node : tree.nodes) {
    out.number(node.number);
    for (const std::int64_t number : {node.size, node.counted}) out.number(static_cast<std::uint64_t>(number));
  }
  out.array(tree.large);
  out.array(tree.before);
}

/// Reads a number of items that follow and are `bytes` long each.
std::uint64_t read_count(MessageReader& in, std::size_t bytes, const char* what) {
  const auto count = in.number<std::uint64_t>(what);
  if (count > in.left() / bytes) in.fail(fmt::format("{} {}, {} bytes are left", count, what, in.left()));
  return count;
}

TreeRequest read_tree(MessageReader& in) {
  TreeRequest tree;
  tree.number = static_cast<int>(in.number<std::uint32_t>("tree"));
  tree.open.tree.nodes.resize(read_count(in, 18, "nodes"));
  for (TreeNode& node : tree.open.tree.nodes) node = read_node(in);
  tree.open.child_of_leaf = in.array<std::int32_t>("leaves");
  tree.open.children = in.number<std::uint64_t>("children");
  tree.nodes.resize(read_count(in, 20, "nodes of the level"));
  for (LevelNode& node : tree.nodes) {
    node.number = in.number<std::uint32_t>("node");
    for (std::int64_t* number : {&node.size, &node.counted}) {
      *number = static_cast<std::int64_t>(in.number<std::uint64_t>("samples"));
    }
  }
  tree.large = in.array<std::int32_t>("large nodes");
  tree.before = in.array<std::int64_t>("ranks");
  return tree;
}

}  // namespace

std::vector<NodeRange> row_groups(const std::vector<LevelNode>& nodes, const SplitOptions& options) {
  return node_runs({0, static_cast<std::int32_t>(nodes.size())}, options.split_pixels,
                   [&](std::int32_t n) { return nodes[n].counted; });
}

std::string set_name(const std::string& sets, std::size_t shard) { return fmt::format("{}/{:06}", sets, shard); }

std::string job_folder(const std::string& name) { return "jobs/" + name; }

std::string job_file(const std::string& name) { return job_folder(name) + "/job"; }

std::string serialise(const TrainJob& job) {
  MessageWriter out;
  out.text(program_build());
  out.number(static_cast<std::uint8_t>(job.kind));
  out.text(job.name);
  write_forest(out, job.forest);
  out.text(toml_of(job.options));
  out.text(job.source);
  out.text(job.sets);
  out.text(job.new_sets);
  out.array(job.first_frames);
  out.number(job.background_frames);
  out.array(job.samples.samples);
  out.array(job.samples.pixels);
  out.number(static_cast<std::uint32_t>(job.trees.size()));
  for (const TreeRequest& tree : job.trees) write_tree(out, tree);
  out.number(static_cast<std::uint32_t>(job.subtrees.size()));
  for (std::size_t i = 0; i < job.subtrees.size(); ++i) {
    out.number(static_cast<std::uint32_t>(job.subtrees[i].tree));
    out.array(job.subtrees[i].nodes);
    for (const std::vector<std::int64_t>& counts : job.root_counts[i]) out.array(counts);
  }
  out.number(static_cast<std::uint32_t>(job.cuts.size()));
  for (const HardCut& cut : job.cuts) {
    out.number(cut.above);
    out.number(cut.ties);
  }
  out.array(job.weights.of_class);
  out.array(job.weights.of_heading);
  out.number(static_cast<std::uint64_t>(job.logits.stride));
  out.number(static_cast<std::uint32_t>(job.logits.of_trees.size()));
  for (const std::vector<std::int16_t>& tree : job.logits.of_trees) out.array(tree);
  for (const int number : {job.gradient.portion, job.gradient.portions, job.gradient.shift}) {
    out.number(static_cast<std::uint32_t>(number));
  }
  return sealed(out.bytes());
}

TrainJob parse_train_job(std::string_view bytes, const std::string& name) {
  const std::string message = opened(bytes, name);
  MessageReader in(message, name);
  expect_this_build(std::string(in.text("build")), name);
  TrainJob job;
  const auto kind = in.number<std::uint8_t>("kind");
  if (kind > kLastKind) in.fail("kind of job");
  job.kind = static_cast<JobKind>(kind);
  job.name = in.text("name");
  job.forest = read_forest(in);
  parse_options(in.text("options"), name, [&](OptionVisitor& visitor) { visit_options("", job.options, visitor); });
  job.source = in.text("source");
  job.sets = in.text("sets");
  job.new_sets = in.text("new sets");
  job.first_frames = in.array<std::uint64_t>("frames");
  if (job.first_frames.empty()) in.fail("no shards");
  job.background_frames = in.number<std::uint64_t>("background");
  job.samples.samples = in.array<std::int64_t>("samples");
  job.samples.pixels = in.array<std::uint64_t>("pixels");
  const auto count = [&](const char* what) {
    const auto number = in.number<std::uint32_t>(what);
    if (number > kMostParts) in.fail(what);
    return number;
  };
  for (std::uint32_t i = count("trees"); i > 0; --i) job.trees.push_back(read_tree(in));
  for (std::uint32_t i = count("subtrees"); i > 0; --i) {
    SubtreeRequest& subtree = job.subtrees.emplace_back();
    subtree.tree = static_cast<std::int32_t>(in.number<std::uint32_t>("tree"));
    subtree.nodes = in.array<std::int32_t>("nodes");
    auto& counts = job.root_counts.emplace_back();
    for (std::size_t n = 0; n < subtree.nodes.size(); ++n) counts.push_back(in.array<std::int64_t>("samples"));
  }
  for (std::uint32_t i = count("cuts"); i > 0; --i) {
    HardCut& cut = job.cuts.emplace_back();
    cut.above = in.number<std::uint32_t>("cut");
    cut.ties = in.number<std::uint64_t>("ties");
  }
  job.weights.of_class = in.array<std::int32_t>("weights");
  job.weights.of_heading = in.array<std::int32_t>("weights");
  job.logits.stride = in.number<std::uint64_t>("stride");
  for (std::uint32_t i = count("trees"); i > 0; --i) job.logits.of_trees.push_back(in.array<std::int16_t>("logits"));
  for (int* number : {&job.gradient.portion, &job.gradient.portions, &job.gradient.shift}) {
    *number = static_cast<int>(in.number<std::uint32_t>("gradient"));
  }
  in.expect_end();
  return job;
}

}  // namespace vesalius
