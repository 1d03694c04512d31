#include "io/model/model_sections.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "io/files/byte_stream.h"
#include "io/files/known_kind.h"

namespace vesalius {
namespace {

// The line ends in it serve the same purpose as PNG's: a text-mode transfer changes them, so this kind of damage can be
// named.
constexpr std::string_view kMagic("\x89VSL\r\n\x1a\n", 8);
constexpr std::size_t kHeaderBytes = 24;  // magic, version, number of sections, bytes and checksum of the table
constexpr std::uint16_t kSkippable = 1;

struct Table {
  std::size_t sections = 0;
  std::string_view bytes;
};

/// Checks magic number, version, length and checksum, in the order in which a user can act on them.
Table read_header(std::string_view bytes, const std::string& name, bool checked) {
  if (bytes.empty()) throw Error(name + ": empty file, expected a vesalius model");
  if (bytes.substr(0, kMagic.size()) != kMagic.substr(0, bytes.size())) {
    throw Error(fmt::format("{}: {}", name,
                            kind_or(bytes, "not a vesalius model (text trees are read by `vesalius convert`)")));
  }
  if (bytes.size() < kHeaderBytes) {
    throw Error(fmt::format("{}: truncated model, {} bytes of the {} of its header", name, bytes.size(), kHeaderBytes));
  }
  ByteReader in(bytes, name);
  in.take(kMagic.size(), "header");
  const auto version = in.number<std::uint16_t>("version");
  if (version > kModelVersion) {
    throw Error(
        fmt::format("{}: written by a newer version: format {}, this program reads {}", name, version, kModelVersion));
  }
  if (version < kModelVersion) {
    throw Error(fmt::format("{}: model of format {}; `vesalius convert OLD NEW` makes it format {}", name, version,
                            kModelVersion));
  }
  Table table;
  table.sections = in.number<std::uint16_t>("number of sections");
  const auto size = in.number<std::uint32_t>("size of the table");
  const auto checksum = in.number<std::uint64_t>("checksum");
  if (in.left() < size) {
    throw Error(fmt::format("{}: truncated model, {} of {} bytes of its table of sections", name, in.left(), size));
  }
  table.bytes = in.take(size, "table of sections");
  if (checked && checksum != xxh64(table.bytes)) {
    throw Error(name + ": damaged model, the checksum of its table of sections does not match");
  }
  return table;
}

}  // namespace

std::uint64_t xxh64(std::string_view bytes, std::string_view rest) {
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  XXH64_update(&state, bytes.data(), bytes.size());
  XXH64_update(&state, rest.data(), rest.size());
  return XXH64_digest(&state);
}

int model_version(std::string_view bytes) {
  if (bytes.size() < kMagic.size() + sizeof(std::uint16_t) || !bytes.starts_with(kMagic)) return 0;
  const std::string name = "model";
  return ByteReader(bytes.substr(kMagic.size()), name).number<std::uint16_t>("version");
}

std::string join_sections(const std::vector<ModelSection>& sections) {
  ByteWriter table;
  for (const ModelSection& section : sections) {
    table.text(section.name);
    table.number(static_cast<std::uint16_t>(section.version));
    table.number(section.skippable ? kSkippable : std::uint16_t{0});
    table.text(section.made_from);
    table.number(static_cast<std::uint64_t>(section.bytes.size()));
    table.number(xxh64(section.bytes));
  }
  ByteWriter out;
  out.bytes() += kMagic;
  out.number(static_cast<std::uint16_t>(kModelVersion));
  out.number(static_cast<std::uint16_t>(sections.size()));
  out.text(table.bytes());
  ByteWriter checksum;
  checksum.number(xxh64(table.bytes()));
  out.bytes().insert(kHeaderBytes - checksum.bytes().size(), checksum.bytes());
  for (const ModelSection& section : sections) out.bytes() += section.bytes;
  return std::move(out.bytes());
}

std::vector<ModelSection> split_sections(std::string_view bytes, const std::string& name, bool checked) {
  const Table table = read_header(bytes, name, checked);
  const std::string table_name = name + ": table of sections";
  ByteReader in(table.bytes, table_name);
  bytes.remove_prefix(kHeaderBytes + table.bytes.size());
  std::vector<ModelSection> sections(table.sections);
  for (ModelSection& section : sections) {
    section.name = in.text("name");
    section.version = in.number<std::uint16_t>("version");
    section.skippable = (in.number<std::uint16_t>("flags") & kSkippable) != 0;
    section.made_from = in.text("what it was made from");
    const auto size = in.number<std::uint64_t>("size");
    section.checksum = in.number<std::uint64_t>("checksum");
    const auto fail = [&](const std::string& what) {
      throw Error(fmt::format("{}: section \"{}\": {}", name, section.name, what));
    };
    if (std::ranges::count(sections, section.name, &ModelSection::name) > 1) fail("is there twice");
    if (bytes.size() < size) fail(fmt::format("truncated, {} of {} bytes", bytes.size(), size));
    section.bytes = bytes.substr(0, size);
    bytes.remove_prefix(size);
    if (checked && section.checksum != xxh64(section.bytes)) fail("damaged, its checksum does not match");
  }
  in.expect_end();
  if (!bytes.empty())
    throw Error(fmt::format("{}: damaged model, {} bytes behind its last section", name, bytes.size()));
  return sections;
}

}  // namespace vesalius
