#include "cluster/merge_records.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace vesalius {
namespace {

constexpr std::uint8_t kPieces = 0, kSums = 1;

}  // namespace

void Pieces::add(std::uint32_t shard, std::string_view message, const std::string& name) {
  const auto [at, fresh] = of_shards_.try_emplace(shard, message);
  if (fresh) {
    bytes_ += message.size();
  } else if (at->second != message) {
    throw Error(fmt::format("{}: shard {} came twice with different messages", name, shard));
  }
}

std::string piece_message(std::uint32_t shard, std::string_view message) {
  MessageWriter out;
  out.number(kPieces);
  out.number(std::uint32_t{1});
  out.number(shard);
  out.text(message);
  return std::move(out.bytes());
}

std::string sums_message(const Sums& sums) {
  MessageWriter out;
  out.number(kSums);
  out.array(sums.shards);
  out.array(sums.numbers);
  return std::move(out.bytes());
}

void KeyMerger::add(std::string_view message, const std::string& name) {
  MessageReader in(message, name);
  const auto kind = in.number<std::uint8_t>("kind");
  if (kind > kSums || (started_ && summed_ != (kind == kSums))) in.fail("kind of message");
  started_ = true;
  summed_ = kind == kSums;
  if (summed_) {
    Sums sums{in.array<std::uint32_t>("shards"), in.array<std::int64_t>("sums")};
    in.expect_end();
    return add_sums(std::move(sums), name);
  }
  for (auto count = in.number<std::uint32_t>("pieces"); count > 0; --count) {
    const auto shard = in.number<std::uint32_t>("shard");
    pieces_.add(shard, in.text("piece"), name);
  }
  in.expect_end();
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
  MessageWriter out;
  out.number(kPieces);
  out.number(static_cast<std::uint32_t>(pieces_.of_shards().size()));
  for (const auto& [shard, piece] : pieces_.of_shards()) {
    out.number(shard);
    out.text(piece);
  }
  return std::move(out.bytes());
}

}  // namespace vesalius
