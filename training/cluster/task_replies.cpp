#include "cluster/task_replies.h"

#include <algorithm>
#include <numeric>

namespace vesalius {

void check(const GroupRows& group, std::size_t nodes, int candidates, const std::string& name) {
  const std::size_t all = std::accumulate(group.rows.begin(), group.rows.end(), std::size_t{0});
  if (group.rows.size() == nodes && group.labels.size() == all && group.low.size() == all * candidates &&
      group.high.size() == group.low.size()) {
    return;
  }
  throw Error(name + ": other numbers of rows and values than expected");
}

std::vector<GrownNode> parse_grown_nodes(std::string_view message, const std::string& name) {
  auto nodes = from_message<std::vector<GrownNode>>(message, name);
  const auto is_inside = [&](const GrownNode& node) { return std::max(node.left, node.right) < nodes.size(); };
  if (nodes.empty() || !std::ranges::all_of(nodes, is_inside)) throw Error(name + ": child beyond the last node");
  return nodes;
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
