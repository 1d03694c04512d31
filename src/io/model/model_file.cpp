#include "io/model/model_file.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "io/files/read_file.h"
#include "io/model/model_trees.h"
#include "vesalius/base/error.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {
namespace {

// The line ends in it serve the same purpose as PNG's: a text-mode transfer changes them, so this kind of damage can be
// named.
constexpr std::string_view kMagic("\x89VSL\r\n\x1a\n", 8);
constexpr std::size_t kSizeAt = 12;
constexpr std::size_t kChecksumAt = 20;
constexpr std::size_t kHeaderBytes = 28;
constexpr std::uint16_t kFlagBackground = 1;
constexpr std::uint16_t kFlagLogits = 2;   ///< leaves were learned jointly and have logits
constexpr std::uint16_t kFlagJudge = 4;    ///< has a judge of people
constexpr std::uint16_t kFlagContext = 8;  ///< has a context of bodies
constexpr std::uint16_t kFlagNames = 16;   ///< judge and context name the features they ask for
constexpr std::uint16_t kAllFlags = kFlagBackground | kFlagLogits | kFlagJudge | kFlagContext | kFlagNames;

std::uint64_t checksum(std::string_view bytes) {
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  XXH64_update(&state, bytes.data(), kChecksumAt);
  XXH64_update(&state, bytes.data() + kHeaderBytes, bytes.size() - kHeaderBytes);
  return XXH64_digest(&state);
}

template <class T>
void overwrite(std::string& bytes, std::size_t at, T value) {
  ByteWriter field;
  field.number(value);
  bytes.replace(at, sizeof(T), field.bytes());
}

/// Checks magic number, version, length and checksum, in the order in which a user can act on them.
void check_header(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw Error(name + ": empty file, expected a vesalius model");
  if (bytes.substr(0, kMagic.size()) != kMagic.substr(0, bytes.size())) {
    throw Error(name + ": not a vesalius model (text trees are read by `vesalius convert`)");
  }
  if (bytes.size() < kHeaderBytes) {
    throw Error(fmt::format("{}: truncated model, {} bytes of the {} of its header", name, bytes.size(), kHeaderBytes));
  }
  ByteReader in(bytes, name);
  in.take(kMagic.size(), "header");
  const auto version = in.number<std::uint16_t>("version");
  if (version != kModelVersion) {
    throw Error(fmt::format("{}: written by {} version: format {}, this program reads {}", name,
                            version > kModelVersion ? "a newer" : "another", version, kModelVersion));
  }
  in.take(2, "flags");
  const auto size = in.number<std::uint64_t>("size");
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

/// Throws unless the body's text describes this body. Only the text is written to the file.
void check_body_text(const BodyModel& body) {
  const BodyModel again = parse_body_model(body.toml, "body model");
  if (!std::ranges::equal(again.parts, body.parts, {}, &BodyPart::name, &BodyPart::name)) {
    throw Error("body model: its text does not give the parts that it has");
  }
}

FacingModel read_facing(ByteReader& in, const Forest& forest) {
  FacingModel facing{forest.headings, forest.body.part_count(), {}};
  const auto count = in.number<std::uint32_t>("weights of headings");
  const std::size_t expected = facing.features() * static_cast<std::size_t>(forest.headings);
  if (count != 0 && count != expected) in.fail(fmt::format("{} weights of headings, expected {}", count, expected));
  for (std::uint32_t i = 0; i < count; ++i) facing.weights.push_back(in.real32("weights of headings"));
  return facing;
}

void write_boosted(ByteWriter& out, const BoostedTrees& boosted, bool names) {
  if (names) {
    out.number(static_cast<std::uint16_t>(boosted.asks.size()));
    for (const std::string& name : boosted.asks) out.text(name);
  }
  out.number(static_cast<std::uint16_t>(boosted.features));
  out.real(boosted.bias);
  out.number(static_cast<std::uint32_t>(boosted.trees.size()));
  for (const BoostedTree& tree : boosted.trees) {
    for (const std::uint16_t feature : tree.feature) out.number(feature);
    for (const float threshold : tree.threshold) out.real(threshold);
    for (const float value : tree.value) out.real(value);
  }
}

BoostedTrees read_boosted(ByteReader& in, const char* what, bool names) {
  BoostedTrees boosted;
  const int named = names ? in.number<std::uint16_t>(what) : 0;
  for (int i = 0; i < named; ++i) boosted.asks.emplace_back(in.text(what));
  boosted.features = in.number<std::uint16_t>(what);
  boosted.bias = in.real32(what);
  const auto count = in.number<std::uint32_t>(what);
  for (std::uint32_t t = 0; t < count; ++t) {
    BoostedTree& tree = boosted.trees.emplace_back();
    for (std::uint16_t& feature : tree.feature) feature = in.number<std::uint16_t>(what);
    for (float& threshold : tree.threshold) threshold = in.real32(what);
    for (float& value : tree.value) value = in.real32(what);
  }
  return boosted;
}

}  // namespace

std::string serialise_model(const Model& model) {
  check(model);
  check_body_text(model.body);
  const Forest& forest = model.forest;
  ByteWriter out;
  out.bytes() += kMagic;
  out.number(static_cast<std::uint16_t>(kModelVersion));
  const bool logits = forest.logit_unit != 0.F;
  const bool judge = !model.judge.empty(), context = !model.context.empty();
  const bool names = !model.judge.asks.empty() || !model.context.asks.empty();
  out.number(static_cast<std::uint16_t>((forest.has_background ? kFlagBackground : 0) | (logits ? kFlagLogits : 0) |
                                        (judge ? kFlagJudge : 0) | (context ? kFlagContext : 0) |
                                        (names ? kFlagNames : 0)));
  out.number(std::uint64_t{0});  // size and checksum, filled in at the end
  out.number(std::uint64_t{0});
  out.text(model.body.toml);
  out.text(forest.recipe);
  out.real(forest.convention.offset_unit);
  out.real(forest.convention.reference_focal_px);
  out.number(forest.convention.hole_mm);
  out.number(forest.convention.outside_mm);
  out.number(forest.convention.clip_mm);
  write_trees(out, forest.trees);
  if (logits) {
    out.real(forest.logit_unit);
    out.number(static_cast<std::uint16_t>(forest.headings));
    write_logits(out, forest.trees);
    out.number(static_cast<std::uint32_t>(model.headings.weights.size()));
    for (const float weight : model.headings.weights) out.real(weight);
  }
  if (context) write_boosted(out, model.context, names);
  if (judge) write_boosted(out, model.judge, names);
  overwrite(out.bytes(), kSizeAt, static_cast<std::uint64_t>(out.bytes().size()));
  overwrite(out.bytes(), kChecksumAt, checksum(out.bytes()));
  return std::move(out.bytes());
}

Model parse_model(std::string_view bytes, const std::string& name) {
  check_header(bytes, name);
  ByteReader in(bytes, name);
  in.take(kMagic.size() + sizeof(std::uint16_t), "header");
  const auto flags = in.number<std::uint16_t>("flags");
  if (flags > kAllFlags) in.fail(fmt::format("unknown flags {}", flags));
  in.take(kHeaderBytes - kSizeAt, "header");
  Model model;
  Forest& forest = model.forest;
  forest.has_background = (flags & kFlagBackground) != 0;
  forest.body = parse_body_model(in.text("body model"), name + ": body model");
  model.body = forest.body;
  forest.recipe = in.text("recipe");
  forest.convention.offset_unit = in.real32("convention");
  forest.convention.reference_focal_px = in.real32("convention");
  forest.convention.hole_mm = in.number<std::uint16_t>("convention");
  forest.convention.outside_mm = in.number<std::uint16_t>("convention");
  forest.convention.clip_mm = in.number<std::uint16_t>("convention");
  forest.trees = read_trees(in);
  if ((flags & kFlagLogits) != 0) {
    forest.logit_unit = in.real32("unit of logits");
    forest.headings = in.number<std::uint16_t>("headings");
    const LogitLayout layout(forest.body, forest.has_background, forest.headings);
    read_logits(in, static_cast<std::size_t>(layout.size()), forest.trees);
    model.headings = read_facing(in, forest);
  }
  const bool names = (flags & kFlagNames) != 0;
  if ((flags & kFlagContext) != 0) model.context = read_boosted(in, "context of bodies", names);
  if ((flags & kFlagJudge) != 0) model.judge = read_boosted(in, "judge of people", names);
  in.expect_end();
  with_context(name, [&] { check(model); });
  return model;
}

std::string model_checksum(std::string_view bytes) {
  return bytes.size() < kHeaderBytes ? std::string() : fmt::format("{:016x}", checksum(bytes));
}

Model load_model(const std::string& path) { return parse_model(read_file(path), path); }

void save_model(const Model& model, const std::string& path) {
  write_file_atomically(path, with_context(path, [&] { return serialise_model(model); }));
}

}  // namespace vesalius
