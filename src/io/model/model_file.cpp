#include "vesalius/model_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "io/files/atomic_file.h"
#include "io/files/byte_stream.h"
#include "io/files/data_file.h"
#include "io/model/model_contents.h"
#include "io/model/model_sections.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// A kind of section. A new one is a row of kContents.
struct Content {
  const char* name;
  int version;
  bool needed;  ///< in every model
  bool (*is_there)(const Model& model);
  std::string (*made_from)(const Model& model);
  void (*write)(ByteWriter& out, const Model& model);
  /// What comes before it in the list is read already.
  void (*read)(ByteReader& in, const ModelSection& section, Model& model);
  int oldest = version;  ///< that is read

  bool reads(const ModelSection& section) const { return section.version >= oldest && section.version <= version; }
};

void read_body(ByteReader& in, const ModelSection& /*section*/, Model& model) {
  model.body = parse_body_model(in.take(in.left(), "body model"), in.name());
  model.forest.body = model.body;
}

void read_forest_section(ByteReader& in, const ModelSection& section, Model& model) {
  read_forest(in, in.number<std::uint16_t>("flags"), model.forest);
  model.forest.recipe = section.made_from;
}

void write_headings_section(ByteWriter& out, const Model& model) {
  out.number(static_cast<std::uint16_t>(model.headings.headings));
  write_headings(out, model.headings);
}

void read_headings_section(ByteReader& in, const ModelSection& section, Model& model) {
  const int headings = in.number<std::uint16_t>("headings");
  model.headings = read_headings(in, headings, model.body.part_count());
  model.headings.made_from = section.made_from;
}

template <BoostedTrees Model::*trees>
constexpr Content boosted(const char* name) {
  return {name,
          1,
          false,
          [](const Model& model) { return !(model.*trees).empty(); },
          [](const Model& model) { return (model.*trees).made_from; },
          [](ByteWriter& out, const Model& model) { write_boosted(out, model.*trees); },
          [](ByteReader& in, const ModelSection& section, Model& model) {
            model.*trees = read_boosted(in, "boosted trees");
            (model.*trees).made_from = section.made_from;
          }};
}

std::string made_by(const Model& model) { return labeller_recipe(model); }

void read_network_section(ByteReader& in, const ModelSection& section, Model& model) {
  auto network = std::make_shared<Network>(read_network(in, section.version > 1));
  network->made_from = section.made_from;
  model.network = std::move(network);
}

constexpr std::array<Content, 6> kContents{
    {{"body", 1, true, [](const Model&) { return true; }, [](const Model&) { return std::string(); },
      [](ByteWriter& out, const Model& model) { out.bytes() += model.body.toml; }, read_body},
     {"forest", 1, false, [](const Model& model) { return model.network == nullptr; }, made_by,
      [](ByteWriter& out, const Model& model) { write_forest(out, model.forest); }, read_forest_section},
     {"network", 2, false, [](const Model& model) { return model.network != nullptr; }, made_by,
      [](ByteWriter& out, const Model& model) { write_network(out, *model.network); }, read_network_section, 1},
     {"headings", 1, false, [](const Model& model) { return !model.headings.empty(); },
      [](const Model& model) { return model.headings.made_from; }, write_headings_section, read_headings_section},
     boosted<&Model::context>("context"),
     boosted<&Model::judge>("judge")}};

/// Throws unless the body's text describes this body. Only the text is written to the file.
void check_body_text(const BodyModel& body) {
  const BodyModel again = parse_body_model(body.toml, "body model");
  if (!std::ranges::equal(again.parts, body.parts, {}, &BodyPart::name, &BodyPart::name)) {
    throw Error("body model: its text does not give the parts that it has");
  }
}

/// Throws where this program does not know a section and may not skip it.
void check_known(const ModelSection& section, const std::string& name) {
  const auto kind = std::ranges::find(kContents, section.name, &Content::name);
  const bool known = kind != kContents.end();
  if (section.skippable && (!known || !kind->reads(section))) return;
  if (!known) {
    throw Error(
        fmt::format("{}: section \"{}\" is not known to this version, which cannot go without it", name, section.name));
  }
  if (!kind->reads(section)) {
    throw Error(fmt::format("{}: section \"{}\" is of version {}, this program reads {}", name, section.name,
                            section.version, kind->version));
  }
}

}  // namespace

std::string serialise_model(const Model& model) {
  if (model.labeller != nullptr) throw Error("model: a labeller in place of its forest, which alone can be written");
  check(model);
  check_body_text(model.body);
  std::vector<ModelSection> sections;
  std::vector<ByteWriter> contents(kContents.size());
  for (std::size_t i = 0; i < kContents.size(); ++i) {
    const Content& kind = kContents[i];
    if (!kind.is_there(model)) continue;
    kind.write(contents[i], model);
    sections.push_back({kind.name, kind.version, false, kind.made_from(model), contents[i].bytes()});
  }
  return join_sections(sections);
}

Model parse_model(std::string_view bytes, const std::string& name) {
  const std::vector<ModelSection> sections = split_sections(bytes, name);
  for (const ModelSection& section : sections) check_known(section, name);
  Model model;
  for (const Content& kind : kContents) {
    const auto section = std::ranges::find_if(
        sections, [&](const ModelSection& each) { return each.name == kind.name && kind.reads(each); });
    if (section == sections.end() && kind.needed) {
      throw Error(fmt::format("{}: no section \"{}\", expected one in every model", name, kind.name));
    }
    if (section == sections.end()) continue;
    const std::string place = fmt::format("{}: section \"{}\"", name, kind.name);
    ByteReader in(section->bytes, place);
    kind.read(in, *section, model);
    in.expect_end();
  }
  if (model.network == nullptr && model.forest.trees.empty()) {
    throw Error(name + R"(: neither a section "forest" nor "network", expected one of them in every model)");
  }
  with_context(name, [&] { check(model); });
  return model;
}

std::string model_checksum(std::string_view bytes) { return fmt::format("{:016x}", xxh64(bytes)); }

Model load_model(const std::string& path) { return parse_model(read_file(path), path); }

void save_model(const Model& model, const std::string& path) {
  write_file_atomically(path, with_context(path, [&] { return serialise_model(model); }));
}

}  // namespace vesalius
