#include "cluster/task_replies.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace vesalius {
namespace {

constexpr std::size_t kNodeBytes = 26;  ///< of a grown node

void write_split(MessageWriter& out, const TreeNode& split) {
  for (const std::int16_t number : {split.du1, split.dv1, split.du2, split.dv2, split.threshold_mm}) {
    out.number(static_cast<std::uint16_t>(number));
  }
}

TreeNode read_split(MessageReader& in) {
  TreeNode split;
  for (std::int16_t* number : {&split.du1, &split.dv1, &split.du2, &split.dv2, &split.threshold_mm}) {
    *number = static_cast<std::int16_t>(in.number<std::uint16_t>("split"));
  }
  return split;
}

}  // namespace

std::string serialise(const PreparedShard& shard) {
  MessageWriter out;
  out.array(shard.samples.samples);
  out.array(shard.samples.pixels);
  out.array(shard.labels.classes);
  out.array(shard.labels.headings);
  for (const std::uint64_t number : {shard.frames, shard.bytes, shard.held_out, shard.hard_negatives})
    out.number(number);
  return std::move(out.bytes());
}

PreparedShard parse_prepared_shard(std::string_view message, const std::string& name) {
  MessageReader in(message, name);
  PreparedShard shard;
  shard.samples.samples = in.array<std::int64_t>("samples");
  shard.samples.pixels = in.array<std::uint64_t>("pixels");
  shard.labels.classes = in.array<std::int64_t>("classes");
  shard.labels.headings = in.array<std::int64_t>("headings");
  for (std::uint64_t* number : {&shard.frames, &shard.bytes, &shard.held_out, &shard.hard_negatives}) {
    *number = in.number<std::uint64_t>("numbers");
  }
  in.expect_end();
  return shard;
}

std::string serialise(const GroupRows& rows) {
  MessageWriter out;
  out.array(rows.rows);
  out.array(rows.labels);
  // High bytes repeat, low ones hardly: zstd makes less of them when they lie apart.
  std::vector<std::uint8_t> low(rows.columns.size()), high(rows.columns.size());
  for (std::size_t i = 0; i < rows.columns.size(); ++i) {
    const auto value = static_cast<std::uint16_t>(rows.columns[i]);
    low[i] = static_cast<std::uint8_t>(value);
    high[i] = static_cast<std::uint8_t>(value >> 8U);
  }
  out.array(low);
  out.array(high);
  return std::move(out.bytes());
}

GroupRows parse_group_rows(std::string_view message, std::size_t nodes, int candidates, const std::string& name) {
  MessageReader in(message, name);
  GroupRows rows;
  rows.rows = in.array<std::uint32_t>("rows");
  rows.labels = in.array<std::uint8_t>("labels");
  const auto low = in.array<std::uint8_t>("values"), high = in.array<std::uint8_t>("values");
  in.expect_end();
  rows.columns.resize(std::min(low.size(), high.size()));
  for (std::size_t i = 0; i < rows.columns.size(); ++i) {
    rows.columns[i] = static_cast<std::int16_t>(low[i] | high[i] << 8U);
  }
  const std::size_t all = std::accumulate(rows.rows.begin(), rows.rows.end(), std::size_t{0});
  if (rows.rows.size() != nodes || rows.labels.size() != all || low.size() != high.size() ||
      rows.columns.size() != all * candidates) {
    in.fail("other numbers of rows and values than expected");
  }
  return rows;
}

std::string serialise(const std::vector<NodeReply>& replies) {
  MessageWriter out;
  out.number(static_cast<std::uint64_t>(replies.size()));
  for (const NodeReply& reply : replies) {
    out.real(reply.gain);
    write_split(out, reply.split);
    out.array(reply.children);
  }
  return std::move(out.bytes());
}

std::vector<NodeReply> parse_node_replies(std::string_view message, const std::string& name) {
  MessageReader in(message, name);
  const auto count = in.number<std::uint64_t>("nodes");
  std::vector<NodeReply> replies;
  for (std::uint64_t i = 0; i < count; ++i) {
    NodeReply& reply = replies.emplace_back();
    reply.gain = in.real64("gain");
    reply.split = read_split(in);
    reply.children = in.array<std::int64_t>("children");
  }
  in.expect_end();
  return replies;
}

std::string serialise(const CountReply& reply) {
  MessageWriter out;
  out.array(reply.totals);
  out.array(reply.before);
  return std::move(out.bytes());
}

CountReply parse_count_reply(std::string_view message, const std::string& name) {
  MessageReader in(message, name);
  CountReply reply{in.array<std::int64_t>("totals"), in.array<std::int64_t>("ranks")};
  in.expect_end();
  return reply;
}

std::string serialise(const std::vector<GrownNode>& nodes) {
  MessageWriter out;
  out.number(static_cast<std::uint64_t>(nodes.size()));
  for (const GrownNode& node : nodes) {
    write_split(out, node.split);
    for (const std::size_t child : {node.left, node.right}) out.number(static_cast<std::uint32_t>(child));
    for (const std::uint8_t label : node.leaf.label) out.number(label);
    for (const std::uint8_t probability : node.leaf.probability) out.number(probability);
  }
  return std::move(out.bytes());
}

std::vector<GrownNode> parse_grown_nodes(std::string_view message, const std::string& name) {
  MessageReader in(message, name);
  const auto count = in.number<std::uint64_t>("nodes");
  if (count == 0 || count * kNodeBytes != in.left()) in.fail("number of nodes");
  std::vector<GrownNode> nodes(count);
  for (GrownNode& node : nodes) {
    node.split = read_split(in);
    for (std::size_t* child : {&node.left, &node.right}) {
      *child = in.number<std::uint32_t>("child");
      if (*child >= count) in.fail("child beyond the last node");
    }
    for (std::uint8_t& label : node.leaf.label) label = in.number<std::uint8_t>("label");
    for (std::uint8_t& probability : node.leaf.probability) probability = in.number<std::uint8_t>("probability");
  }
  return nodes;
}

std::string serialise(const HardCounts& counts) {
  MessageWriter out;
  out.number(static_cast<std::uint64_t>(counts.background));
  out.array(counts.counts);
  return std::move(out.bytes());
}

HardCounts parse_hard_counts(std::string_view message, const std::string& name) {
  MessageReader in(message, name);
  HardCounts counts;
  counts.background = static_cast<std::int64_t>(in.number<std::uint64_t>("background"));
  counts.counts = in.array<std::uint64_t>("counts");
  in.expect_end();
  return counts;
}

std::string serialise(const std::vector<FacingSample>& samples) {
  MessageWriter out;
  out.number(static_cast<std::uint32_t>(samples.size()));
  for (const FacingSample& sample : samples) {
    out.array(sample.features);
    out.number(static_cast<std::uint8_t>(sample.heading));
  }
  return std::move(out.bytes());
}

std::vector<FacingSample> parse_facing_samples(std::string_view message, const std::string& name) {
  MessageReader in(message, name);
  std::vector<FacingSample> samples;
  for (auto count = in.number<std::uint32_t>("people"); count > 0; --count) {
    FacingSample& sample = samples.emplace_back();
    sample.features = in.array<float>("features");
    sample.heading = in.number<std::uint8_t>("heading");
  }
  in.expect_end();
  return samples;
}

std::string shard_key(std::size_t shard) { return fmt::format("{:08}", shard); }

std::string tree_key(std::size_t tree) { return fmt::format("{:05}", tree); }

std::string node_key(std::size_t tree, std::size_t node, std::size_t block) {
  return fmt::format("{:05}.{:010}.{:05}", tree, node, block);
}

std::vector<std::size_t> key_numbers(const std::string& key, std::size_t count, const std::string& name) {
  std::vector<std::size_t> numbers{0};
  bool digit = false;
  for (const char c : key) {
    if (c >= '0' && c <= '9') {
      numbers.back() = 10 * numbers.back() + static_cast<std::size_t>(c - '0');
      digit = true;
    } else if (c == '.' && digit) {
      numbers.push_back(0);
      digit = false;
    } else {
      digit = false;
      break;
    }
  }
  if (!digit || numbers.size() != count) throw Error(fmt::format("{}: unexpected key {}", name, key));
  return numbers;
}

}  // namespace vesalius
