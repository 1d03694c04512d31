#include "cluster/message.h"

#include <link.h>
#include <openssl/evp.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>

#include "io/files/packed.h"

namespace vesalius {
namespace {

constexpr std::uint32_t kMagic = 0x534D5356;  // "VSMS"
constexpr std::uint16_t kVersion = 2;
constexpr int kLevel = 1;  ///< level of compression: messages are written and read once
constexpr std::size_t kLargest = std::size_t{1} << 32U;
/// What is damaged in a store stays damaged.
constexpr const char* kAnew = "; --restart begins anew";

std::string in_base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   reinterpret_cast<const unsigned char*>(bytes.data()), int(bytes.size()));
  text.resize(size);
  return text;
}

std::string from_base64(std::string_view text, const std::string& name) {
  std::string bytes(3 * (text.size() / 4) + 3, '\0');
  const int size = text.size() % 4 != 0 || text.empty()
                       ? -1
                       : EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                         reinterpret_cast<const unsigned char*>(text.data()), int(text.size()));
  if (size < 0) throw Error(name + ": damaged, expected base 64 after the tab" + kAnew);
  bytes.resize(size - (text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0));
  return bytes;
}

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

/// Returns a hash of the program's code and of what its linker noted of all else. As they are in memory: the file that
/// runs is the loader's where a bundle brings its own.
std::uint64_t hash_of_program() {
  std::uint64_t hash = 0;
  const auto add = [](dl_phdr_info* program, std::size_t /*size*/, void* sum) {
    auto& so_far = *static_cast<std::uint64_t*>(sum);
    for (const auto& segment : std::span(program->dlpi_phdr, program->dlpi_phnum)) {
      const bool is_code = segment.p_type == PT_LOAD && (segment.p_flags & PF_X) != 0;
      if (!is_code && segment.p_type != PT_NOTE) continue;
      // NOLINTNEXTLINE(performance-no-int-to-ptr): where the program lies is given as a number
      so_far = XXH3_64bits_withSeed(reinterpret_cast<const void*>(program->dlpi_addr + segment.p_vaddr),
                                    segment.p_filesz, so_far);
    }
    return 1;  // its libraries follow
  };
  dl_iterate_phdr(add, &hash);
  return hash;
}

}  // namespace

std::string sealed(std::string_view message) {
  const std::string packed = pack(message, kLevel);
  ByteWriter out;
  out.number(kMagic);
  out.number(kVersion);
  out.number(static_cast<std::uint64_t>(XXH64(packed.data(), packed.size(), 0)));
  out.bytes() += packed;
  return std::move(out.bytes());
}

std::string opened(std::string_view envelope, const std::string& name) {
  ByteReader in(envelope, name);
  if (in.number<std::uint32_t>("the mark of a message") != kMagic)
    throw Error(name + ": no message of vesalius" + kAnew);
  const auto version = in.number<std::uint16_t>("version");
  if (version != kVersion) {
    throw Error(fmt::format("{}: message of version {}, expected {}: the machines have different versions of vesalius",
                            name, version, kVersion));
  }
  const auto expected = in.number<std::uint64_t>("checksum");
  const std::string_view rest = envelope.substr(envelope.size() - in.left());
  if (XXH64(rest.data(), rest.size(), 0) != expected)
    throw Error(name + ": damaged, its checksum does not match" + kAnew);
  std::string message = read_packed(in, 0, kLargest, "message");
  in.expect_end();
  return message;
}

std::string record_line(const Record& record) { return record.key + '\t' + in_base64(sealed(record.message)) + '\n'; }

Record parse_record(std::string_view line, const std::string& name) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  const std::size_t tab = line.find('\t');
  if (tab == std::string_view::npos || tab == 0) throw Error(name + ": expected a key, a tab and a message" + kAnew);
  Record record{std::string(line.substr(0, tab)), {}};
  const std::string where = name + ": " + record.key;
  record.message = opened(from_base64(line.substr(tab + 1), where), where);
  return record;
}

std::string program_build() {
  static const std::string build = fmt::format("vesalius {} of hash {:016x}", VESALIUS_VERSION, hash_of_program());
  return build;
}

void expect_this_build(const std::string& build, const std::string& name) {
  if (build == program_build()) return;
  throw Error(fmt::format("{}: made by {}, this machine has {}; expected the same on all machines", name, build,
                          program_build()));
}

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

void check(const GroupRows& group, std::size_t nodes, int candidates, const std::string& name) {
  const std::size_t all = std::accumulate(group.rows.begin(), group.rows.end(), std::size_t{0});
  if (group.rows.size() == nodes && group.labels.size() == all && group.low.size() == all * candidates &&
      group.high.size() == group.low.size()) {
    return;
  }
  throw Error(name + ": other numbers of rows and values than expected");
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
