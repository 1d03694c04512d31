#include "cluster/merge_records.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "cluster/message.h"

namespace vesalius {
namespace {

struct Piece {
  std::uint32_t shard = 0;
  std::string message;

  static void visit_fields(auto&& visit, auto&... of) { visit("shard", of.shard...)("message", of.message...); }
};

/// What is under a key: either pieces or sums.
struct KeyMessage {
  bool summed = false;
  std::vector<Piece> pieces = {};
  Sums sums = {};

  static void visit_fields(auto&& visit, auto&... of) {
    visit("summed", of.summed...)("pieces", of.pieces...)("sums", of.sums...);
  }
};

}  // namespace

std::string piece_message(std::uint32_t shard, std::string_view message) {
  return to_message(KeyMessage{.pieces = {{shard, std::string(message)}}});
}

std::string sums_message(const Sums& sums) { return to_message(KeyMessage{.summed = true, .sums = sums}); }

void KeyMerger::add(std::string_view message, const std::string& name) {
  auto more = from_message<KeyMessage>(message, name);
  if (started_ && summed_ != more.summed) throw Error(name + ": pieces and sums under one key");
  started_ = true;
  summed_ = more.summed;
  if (summed_) return add_sums(std::move(more.sums), name);
  for (Piece& piece : more.pieces) add_piece(piece.shard, std::move(piece.message), name);
}

void KeyMerger::add_piece(std::uint32_t shard, std::string message, const std::string& name) {
  const std::size_t bytes = message.size();
  const auto [at, fresh] = pieces_.try_emplace(shard, std::move(message));
  if (fresh) {
    piece_bytes_ += bytes;
  } else if (at->second != message) {
    throw Error(fmt::format("{}: shard {} came twice with different messages", name, shard));
  }
}

void KeyMerger::add_sums(Sums sums, const std::string& name) {
  if (std::ranges::find(added_, sums.shards) != added_.end()) return;
  std::vector<std::uint32_t> all, common;
  std::ranges::set_intersection(sums_.shards, sums.shards, std::back_inserter(common));
  if (!common.empty()) throw Error(fmt::format("{}: shard {} came twice in different sums", name, common.front()));
  std::ranges::set_union(sums_.shards, sums.shards, std::back_inserter(all));
  added_.push_back(std::move(sums.shards));
  sums_.shards = std::move(all);
  if (sums_.numbers.empty()) {
    sums_.numbers = std::move(sums.numbers);
    return;
  }
  if (sums_.numbers.size() != sums.numbers.size()) throw Error(name + ": sums of different lengths");
  for (std::size_t i = 0; i < sums.numbers.size(); ++i) sums_.numbers[i] += sums.numbers[i];
}

std::string KeyMerger::message() const {
  if (summed_) return sums_message(sums_);
  KeyMessage all;
  for (const auto& [shard, piece] : pieces_) all.pieces.push_back({shard, piece});
  return to_message(all);
}

}  // namespace vesalius
