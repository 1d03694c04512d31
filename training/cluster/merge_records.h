#pragma once

// How messages of one key merge, in combiners and reducers. There are two kinds: pieces are kept side by side, each
// with the shard it comes from; sums are added, with the list of shards in them. What comes twice counts once, since
// engines may deliver the output of a task again.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// Messages of several shards under one key, not added.
using Pieces = std::map<std::uint32_t, std::string>;

/// Integers summed over shards.
struct Sums {
  std::vector<std::uint32_t> shards;  ///< ascending
  std::vector<std::int64_t> numbers;

  static void visit_fields(auto&& visit, auto&... of) { visit("shards", of.shards...)("numbers", of.numbers...); }
};

std::string piece_message(std::uint32_t shard, std::string_view message);
std::string sums_message(const Sums& sums);

/// Merges all messages of one key.
class KeyMerger {
 public:
  /// Adds a message of either kind. Throws Error naming `name` if it is damaged, is of the other kind or another
  /// length than those before, or shares only some of the shards with them.
  void add(std::string_view message, const std::string& name);
  /// Returns the merged message.
  std::string message() const;
  const Pieces& pieces() const { return pieces_; }
  const Sums& sums() const { return sums_; }
  /// The size in bytes of what is held.
  std::size_t bytes() const { return piece_bytes_ + sums_.numbers.size() * sizeof(std::int64_t); }

 private:
  void add_piece(std::uint32_t shard, std::string message, const std::string& name);
  void add_sums(Sums sums, const std::string& name);

  bool summed_ = false, started_ = false;
  Pieces pieces_;
  std::size_t piece_bytes_ = 0;
  Sums sums_;
  std::vector<std::vector<std::uint32_t>> added_;  ///< lists of shards that were added
};

}  // namespace vesalius
