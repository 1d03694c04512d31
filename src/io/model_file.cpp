#include "io/model_file.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "io/atomic_file.h"
#include "io/byte_stream.h"
#include "io/read_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

// Like PNG's: a text-mode transfer changes it, so the damage is named for what it is.
constexpr std::string_view kMagic("\x89VSL\r\n\x1a\n", 8);
constexpr std::size_t kChecksumAt = 20;
constexpr std::size_t kHeaderBytes = 28;
constexpr std::uint16_t kFlagBackground = 1;

// Where a node's child is: most often the next one not yet reached, which costs no further byte.
enum Child : unsigned { kNextNode = 0, kNextLeaf = 1, kOtherNode = 2, kOtherLeaf = 3 };
// A leaf that is one class for certain: its label follows, no probabilities.
constexpr unsigned kCertainLeaf = 0x10;

constexpr std::size_t kSmallestNode = 6;
constexpr std::size_t kSmallestLeaf = 1;

std::uint64_t checksum(std::string_view bytes) {
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  XXH64_update(&state, bytes.data(), kChecksumAt);
  XXH64_update(&state, bytes.data() + kHeaderBytes, bytes.size() - kHeaderBytes);
  return XXH64_digest(&state);
}

class Writer : public ByteWriter {
 public:
  /// Small numbers of either sign stay short: 0, -1, 1, -2 ... become 0, 1, 2, 3 ...
  void signed_varint(int value) { varint((static_cast<std::uint32_t>(value) << 1U) ^ (value < 0 ? 0xFFFFFFFFU : 0U)); }
  template <class T>
  void overwrite(std::size_t at, T value) {
    ByteWriter field;
    field.number(value);
    bytes().replace(at, sizeof(T), field.bytes());
  }
  std::size_t size() { return bytes().size(); }
};

class Reader : public ByteReader {
 public:
  Reader(std::string_view bytes, std::size_t at, const std::string& name) : ByteReader(bytes, name) {
    take(at, "header");
  }

  std::int16_t int16(const char* what) {
    const std::uint32_t code = varint(what);
    if (code > 0xFFFF) fail(fmt::format("{}: number does not fit 16 bits", what));
    return static_cast<std::int16_t>((code >> 1U) ^ ((code & 1U) != 0 ? 0xFFFFU : 0U));
  }
  /// A count of items of at least `smallest` bytes each, so that no file asks for more memory than its size warrants.
  std::size_t count(std::size_t smallest, const char* what) {
    const auto value = number<std::uint32_t>(what);
    if (value > left() / smallest) fail(fmt::format("{} {} cannot be in the {} bytes left", value, what, left()));
    return value;
  }
};

/// Children in the order of the file, so that both sides agree on which is the next.
struct NextChild {
  std::int32_t node = 1;
  std::int32_t leaf = 0;

  unsigned kind_of(std::int32_t child) {
    if (child == node) return ++node, kNextNode;
    if (child == ~leaf) return ++leaf, kNextLeaf;
    return child >= 0 ? kOtherNode : kOtherLeaf;
  }
};

void write_tree(Writer& out, const Tree& tree) {
  out.number(static_cast<std::uint32_t>(tree.nodes.size()));
  out.number(static_cast<std::uint32_t>(tree.leaves.size()));
  NextChild next;
  for (const TreeNode& node : tree.nodes) {
    const unsigned left = next.kind_of(node.left);
    const unsigned right = next.kind_of(node.right);
    out.number(static_cast<std::uint8_t>(left | (right << 2U)));
    for (const int value : {node.du1, node.dv1, node.du2, node.dv2, node.threshold_mm}) out.signed_varint(value);
    if (left >= kOtherNode) out.varint(static_cast<std::uint32_t>(node.left >= 0 ? node.left : ~node.left));
    if (right >= kOtherNode) out.varint(static_cast<std::uint32_t>(node.right >= 0 ? node.right : ~node.right));
  }
  for (const TreeLeaf& leaf : tree.leaves) {
    unsigned used = 0;
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) used |= leaf.probability[k] != 0 ? 1U << k : 0U;
    const bool certain = leaf.probability[0] == 255;
    out.number(static_cast<std::uint8_t>(certain ? kCertainLeaf : used));
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
      if (leaf.probability[k] == 0) continue;
      out.number(leaf.label[k]);
      if (!certain) out.number(leaf.probability[k]);
    }
  }
}

std::int32_t read_child(Reader& in, unsigned kind, NextChild& next) {
  if (kind == kNextNode) return next.node++;
  if (kind == kNextLeaf) return ~next.leaf++;
  const std::uint32_t index = in.varint("child");
  if (index > static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max())) in.fail("child: out of range");
  return kind == kOtherNode ? static_cast<std::int32_t>(index) : ~static_cast<std::int32_t>(index);
}

TreeNode read_node(Reader& in, NextChild& next) {
  const auto kinds = in.number<std::uint8_t>("node");
  if (kinds > 0x0F) in.fail(fmt::format("node: unknown kind {}", kinds));
  TreeNode node;
  for (std::int16_t* value : {&node.du1, &node.dv1, &node.du2, &node.dv2, &node.threshold_mm}) {
    *value = in.int16("node");
  }
  node.left = read_child(in, kinds & 3U, next);
  node.right = read_child(in, kinds >> 2U, next);
  return node;
}

TreeLeaf read_leaf(Reader& in) {
  TreeLeaf leaf;
  const auto used = in.number<std::uint8_t>("leaf");
  if (used > kCertainLeaf) in.fail(fmt::format("leaf: unknown kind {}", used));
  if (used == kCertainLeaf) {
    leaf.label[0] = in.number<std::uint8_t>("leaf");
    leaf.probability[0] = 255;
    return leaf;
  }
  for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
    if ((used >> k & 1U) == 0) continue;
    leaf.label[k] = in.number<std::uint8_t>("leaf");
    leaf.probability[k] = in.number<std::uint8_t>("leaf");
  }
  return leaf;
}

Tree read_tree(Reader& in) {
  const std::size_t nodes = in.count(kSmallestNode, "nodes");
  const std::size_t leaves = in.count(kSmallestLeaf, "leaves");
  Tree tree;
  tree.nodes.reserve(nodes);
  tree.leaves.reserve(leaves);
  NextChild next;
  for (std::size_t n = 0; n < nodes; ++n) tree.nodes.push_back(read_node(in, next));
  for (std::size_t l = 0; l < leaves; ++l) tree.leaves.push_back(read_leaf(in));
  return tree;
}

/// Magic, version, length and checksum: what went wrong on the way, in the order that a user can act on.
void check_header(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw Error(name + ": empty file, expected a vesalius model");
  if (bytes.substr(0, kMagic.size()) != kMagic.substr(0, bytes.size())) {
    throw Error(name + ": not a vesalius model (text trees are read by `vesalius convert`)");
  }
  if (bytes.size() < kHeaderBytes) {
    throw Error(fmt::format("{}: truncated model, {} bytes of the {} of its header", name, bytes.size(), kHeaderBytes));
  }
  Reader in(bytes, kMagic.size(), name);
  const auto version = in.number<std::uint16_t>("version");
  if (version > kModelVersion) {
    throw Error(fmt::format("{}: written by a newer version: format {}, this program reads up to {}", name, version,
                            kModelVersion));
  }
  in.take(2, "flags");
  const auto size = in.number<std::uint64_t>("size");
  if (version == 0) throw Error(name + ": damaged model, format 0");
  if (bytes.size() < size) {
    throw Error(fmt::format("{}: truncated model, {} of {} bytes", name, bytes.size(), size));
  }
  if (bytes.size() > size) {
    throw Error(fmt::format("{}: damaged model, {} bytes where its header says {}", name, bytes.size(), size));
  }
  if (in.number<std::uint64_t>("checksum") != checksum(bytes)) {
    throw Error(name + ": damaged model, the checksum does not match");
  }
}

/// The text is all that is written of the body; it must be this body's.
void check_body_text(const BodyModel& body) {
  const BodyModel again = parse_body_model(body.toml, "body model");
  if (!std::ranges::equal(again.parts, body.parts, {}, &BodyPart::name, &BodyPart::name)) {
    throw Error("body model: its text does not give the parts that it has");
  }
}

}  // namespace

std::string serialise_model(const Forest& forest) {
  check(forest);
  check_body_text(forest.body);
  Writer out;
  out.bytes() += kMagic;
  out.number(static_cast<std::uint16_t>(kModelVersion));
  out.number(static_cast<std::uint16_t>(forest.has_background ? kFlagBackground : 0));
  out.number(std::uint64_t{0});  // size and checksum, known at the end
  out.number(std::uint64_t{0});
  out.text(forest.body.toml);
  out.text(forest.recipe);
  out.real(forest.convention.offset_unit);
  out.real(forest.convention.reference_focal_px);
  out.number(forest.convention.hole_mm);
  out.number(forest.convention.outside_mm);
  out.number(forest.convention.clip_mm);
  out.number(static_cast<std::uint32_t>(forest.trees.size()));
  for (const Tree& tree : forest.trees) write_tree(out, tree);
  out.overwrite(kChecksumAt - sizeof(std::uint64_t), static_cast<std::uint64_t>(out.size()));
  out.overwrite(kChecksumAt, checksum(out.bytes()));
  return std::move(out.bytes());
}

Forest parse_model(std::string_view bytes, const std::string& name) {
  check_header(bytes, name);
  Reader in(bytes, kMagic.size() + sizeof(std::uint16_t), name);
  const auto flags = in.number<std::uint16_t>("flags");
  if (flags > kFlagBackground) in.fail(fmt::format("unknown flags {}", flags));
  in.take(kHeaderBytes - kChecksumAt + sizeof(std::uint64_t), "header");
  Forest forest;
  forest.has_background = flags == kFlagBackground;
  forest.body = parse_body_model(in.text("body model"), name + ": body model");
  forest.recipe = in.text("recipe");
  forest.convention.offset_unit = in.real32("convention");
  forest.convention.reference_focal_px = in.real32("convention");
  forest.convention.hole_mm = in.number<std::uint16_t>("convention");
  forest.convention.outside_mm = in.number<std::uint16_t>("convention");
  forest.convention.clip_mm = in.number<std::uint16_t>("convention");
  const std::size_t trees = in.count(2 * sizeof(std::uint32_t), "trees");
  for (std::size_t t = 0; t < trees; ++t) forest.trees.push_back(read_tree(in));
  if (in.left() != 0) in.fail("expected the end of the file");
  with_context(name, [&] { check(forest); });
  return forest;
}

std::string model_checksum(std::string_view bytes) {
  return bytes.size() < kHeaderBytes ? std::string() : fmt::format("{:016x}", checksum(bytes));
}

Forest load_model(const std::string& path) { return parse_model(read_file(path), path); }

void save_model(const Forest& forest, const std::string& path) {
  write_file_atomically(path, with_context(path, [&] { return serialise_model(forest); }));
}

}  // namespace vesalius
