#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/files/byte_stream.h"
#include "train/growing_tree.h"
#include "train/messages/training_messages.h"
#include "vesalius/camera.h"
#include "vesalius/forest.h"

// What tasks and driver of a cluster send each other (docs/formats.md): bytes in an envelope with version and checksum.
namespace vesalius {

static_assert(std::endian::native == std::endian::little, "messages are little endian");

/// Core types whose fields are named below: `visit_fields(visitor, const Camera&)` is one as well.
template <class T, class Type>
concept Is = std::same_as<std::remove_const_t<T>, Type>;

void visit_fields(auto& visit, Is<Camera> auto& of) {
  visit("width", of.width)("height", of.height)("fx", of.fx)("fy", of.fy)("cx", of.cx)("cy", of.cy);
}
void visit_fields(auto& visit, Is<Tree> auto& of) {
  visit("nodes", of.nodes)("leaves", of.leaves)("logits", of.logits);
}

/// What is written as it lies in memory: numbers, and structs of numbers without bytes between them.
template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T> ||
    (std::is_class_v<T>&& std::has_unique_object_representations_v<T>);

/// Writes messages field by field (`visit_fields`); what may be long, texts too, behind a u64 with its number of
/// elements.
class MessageWriter : public ByteWriter {
 public:
  template <class T>
  MessageWriter& operator()(const char* name, const T& value) {
    if constexpr (Plain<T>) {
      append(&value, 1);
    } else if constexpr (HasFields<T>) {
      T::visit_fields(*this, value);
    } else if constexpr (requires { value.size(); }) {
      number(static_cast<std::uint64_t>(value.size()));
      if constexpr (Plain<typename T::value_type>) {
        append(value.data(), value.size());
      } else {
        for (const auto& element : value) (*this)(name, element);
      }
    } else {
      visit_fields(*this, value);
    }
    return *this;
  }

 private:
  template <class T>
  void append(const T* values, std::size_t count) {
    bytes().append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
};

template <class T>
std::string to_message(const T& value) {
  MessageWriter out;
  out("message", value);
  return std::move(out.bytes());
}

/// Reads what MessageWriter wrote. Memory is only taken for what may be in the bytes that are left.
class MessageReader : public ByteReader {
 public:
  using ByteReader::ByteReader;

  template <class T>
  MessageReader& operator()(const char* name, T& value) {
    if constexpr (std::same_as<T, bool>) {
      value = number<std::uint8_t>(name) != 0;
    } else if constexpr (Plain<T>) {
      copy(name, &value, 1);
    } else if constexpr (HasFields<T>) {
      T::visit_fields(*this, value);
    } else if constexpr (requires { value.size(); }) {
      using Element = typename T::value_type;
      const auto size = number<std::uint64_t>(name);
      static const std::size_t least = least_bytes<Element>();
      if (size > left() / least) fail(fmt::format("{} elements of {}, {} bytes are left", size, name, left()));
      value.resize(size);
      if constexpr (Plain<Element>) {
        copy(name, value.data(), size);
      } else {
        for (Element& element : value) (*this)(name, element);
      }
    } else {
      visit_fields(*this, value);
    }
    return *this;
  }

 private:
  /// Returns the bytes of a message in which all that may be long is empty.
  template <class T>
  static std::size_t least_bytes() {
    MessageWriter out;
    out("message", T{});
    return out.bytes().size();
  }
  template <class T>
  void copy(const char* name, T* values, std::size_t count) {
    const std::string_view raw = take(count * sizeof(T), name);
    if (count > 0) std::memcpy(values, raw.data(), raw.size());
  }
};

/// Returns the message in these bytes. Throws Error naming `name` if they are damaged.
template <class T>
T from_message(std::string_view bytes, const std::string& name) {
  MessageReader in(bytes, name);
  T value;
  in("message", value);
  in.expect_end();
  return value;
}

/// Returns a message in its envelope: compressed, with the version of all messages and a checksum.
std::string sealed(std::string_view message);
/// Returns the message in an envelope. Throws Error naming `name` if it is damaged or of another version.
std::string opened(std::string_view envelope, const std::string& name);

/// A message under a key, as tasks read and write it: a line of the key, a tab, and the envelope in base 64. Sorted
/// lines have the messages of a key side by side.
struct Record {
  std::string key;  ///< without tabs and line ends
  std::string message;
};

/// Returns the line, with its end.
std::string record_line(const Record& record);
/// Returns the record of a line. Throws Error naming its key and `name` if it is damaged.
Record parse_record(std::string_view line, const std::string& name);

/// Returns how this program was built. Programs that differ may not work on one training, since their bytes might.
std::string program_build();
/// Throws Error naming `name`, which another machine wrote, unless its program was built as this one.
void expect_this_build(const std::string& build, const std::string& name);

// How messages of one key merge, in combiners and reducers. There are two kinds: pieces are kept side by side, each
// with the shard it comes from; sums are added, with the list of shards in them. What comes twice counts once, since
// engines may deliver the output of a task again.

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

/// Leaves whose numbers are in one message: what a reducer holds of a key.
inline constexpr std::size_t kLeafBlock = 2048;
/// Key of the likelihoods beside the gradients.
inline constexpr const char* kLikelihoodKey = "likelihood";

/// What is known of a shard's set.
struct PreparedShard {
  SampleCounts samples;
  LabelCounts labels;
  std::uint64_t frames = 0, bytes = 0, held_out = 0;
  std::uint64_t hard_negatives = 0;  ///< samples that were added

  static void visit_fields(auto&& visit, auto&... of) {
    visit("samples", of.samples...)("labels", of.labels...)("frames", of.frames...)("bytes", of.bytes...)(
        "held out", of.held_out...)("hard negatives", of.hard_negatives...);
  }
};

/// Values of the counted samples of neighbouring nodes for one block of candidates, in one shard; node by node.
struct GroupRows {
  std::vector<std::uint32_t> rows;   ///< [node]
  std::vector<std::uint8_t> labels;  ///< [row of the node]
  /// Values, [candidate * rows of the node + row of the node], mm. High bytes repeat, low ones hardly: zstd makes less
  /// of them when they lie apart.
  std::vector<std::uint8_t> low, high;

  std::int16_t value(std::size_t at) const { return static_cast<std::int16_t>(low[at] | high[at] << 8U); }

  static void visit_fields(auto&& visit, auto&... of) {
    visit("rows", of.rows...)("labels", of.labels...)("low", of.low...)("high", of.high...);
  }
};
/// Throws Error naming `name` unless there are `nodes` nodes and `candidates` values in a row.
void check(const GroupRows& group, std::size_t nodes, int candidates, const std::string& name);

/// The best split of a node among one block of candidates.
struct NodeReply {
  double gain = 0.0;  ///< bits per sample; 0 if there is none
  TreeNode split;
  std::vector<std::int64_t> children;  ///< [side * classes + class]: its counted samples

  static void visit_fields(auto&& visit, auto&... of) {
    visit("gain", of.gain...)("split", of.split...)("children", of.children...);
  }
};

/// Samples at the children of large nodes.
struct CountReply {
  std::vector<std::int64_t> totals;  ///< [child * classes + class], all shards
  std::vector<std::int64_t> before;  ///< [shard * children + child]: in all shards before that one

  static void visit_fields(auto&& visit, auto&... of) { visit("totals", of.totals...)("before", of.before...); }
};

/// How well leaves in learning do.
struct Likelihood {
  double log_likelihood = 0.0, weight = 0.0;  ///< as in LeafGradient

  static void visit_fields(auto&& visit, auto&... of) {
    visit("log likelihood", of.log_likelihood...)("weight", of.weight...);
  }
};

/// Keys: numbers of fixed width, so that lines sort as numbers do.
std::string shard_key(std::size_t shard);
std::string tree_key(std::size_t tree);
std::string node_key(std::size_t tree, std::size_t node, std::size_t block);
/// Reads the numbers of a key. Throws Error naming `name` if there are not `count`.
std::vector<std::size_t> key_numbers(const std::string& key, std::size_t count, const std::string& name);

}  // namespace vesalius
