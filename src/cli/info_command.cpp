#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "console/satellites.h"
#include "console/text_sink.h"
#include "io/files/data_file.h"
#include "io/files/plain_text.h"
#include "io/model/model_sections.h"
#include "io/recordings/recording_formats.h"
#include "io/sensors/sensor_drivers.h"
#include "io/sources/folder_source.h"
#include "vesalius/model_file.h"
#include "vesalius/network/network.h"
#include "vesalius/open_source.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> cpu_features() {
  std::vector<std::string> found;
#if defined(__x86_64__)
  const auto add = [&](const char* name, int supported) {
    if (supported != 0) found.emplace_back(name);
  };
  add("sse4.2", __builtin_cpu_supports("sse4.2"));
  add("avx", __builtin_cpu_supports("avx"));
  add("avx2", __builtin_cpu_supports("avx2"));
  add("avx512f", __builtin_cpu_supports("avx512f"));
#endif
  return found;
}

/// Returns which optional parts this build has.
Json part_facts() {
  Json facts = Json::object();
  for (const std::string& name : satellite_names()) facts[name] = "absent";
  for (const Satellite& satellite : satellites()) {
    facts[satellite.name] = "present";
    if (satellite.facts == nullptr) continue;
    Json& more = facts[satellite.name] = Json::object();
    for (const auto& [name, value] : satellite.facts()) more[name] = value;
  }
  for (const SensorDriver& driver : sensor_drivers()) {
    facts[std::string(driver.scheme)] = driver.built ? "present" : "absent";
  }
  facts["mkv"] = has_mkv() ? "present" : "absent";
  facts["k4a"] = "absent";
  return facts;
}

Json program_facts() {
  return {{"program", "vesalius"},
          {"version", VESALIUS_VERSION},
          {"build", VESALIUS_BUILD_TYPE},
          {"compiler",
#if defined(__clang__)
           std::string("clang ") + __clang_version__
#else
           std::string("gcc ") + __VERSION__
#endif
          },
          {"cpu_features", cpu_features()},
          {"threads", thread_count()},
          {"model_format", kModelVersion},
          {"parts_of_this_build", part_facts()}};
}

Json tree_facts(const Tree& tree) {
  return {{"depth", depth(tree)}, {"nodes", tree.nodes.size()}, {"leaves", tree.leaves.size()}};
}

/// Returns the bytes of the file per node, leaves included; null for a forest without nodes.
Json bytes_per_node(std::size_t bytes, std::size_t nodes) {
  if (nodes == 0) return nullptr;
  return std::round(100.0 * double(bytes) / double(nodes)) / 100.0;
}

Json body_facts(const BodyModel& body) {
  Json parts = Json::array();
  for (const BodyPart& part : body.parts) parts.push_back(part.name);
  Json sets = Json::array();
  for (const JointSet& set : body.joint_sets) sets.push_back(set.name);
  return {{"name", body.name}, {"parts", std::move(parts)}, {"joint_sets", std::move(sets)}};
}

/// Returns the sections of a model file. What the forest or network was made from is its recipe, which stands alone.
Json section_facts(const std::vector<ModelSection>& sections) {
  Json facts = Json::array();
  for (const ModelSection& section : sections) {
    Json& one = facts.emplace_back(Json{{"name", section.name},
                                        {"version", section.version},
                                        {"bytes", section.bytes.size()},
                                        {"checksum", fmt::format("{:016x}", section.checksum)}});
    const bool recipe = section.name == "forest" || section.name == "network";
    if (!recipe && !section.made_from.empty()) one["made_from"] = section.made_from;
  }
  return facts;
}

Json network_facts(const Network& network) {
  std::size_t weights = 0;
  for (const Convolution& layer : network.layers) weights += layer.weights.size();
  return {{"layers", network.layers.size()}, {"weights", weights}};
}

/// Returns what is known of the trees of a model.
Json forest_facts(const Forest& forest, std::size_t size_bytes) {
  Json trees = Json::array();
  std::size_t nodes = 0, leaves = 0;
  for (const Tree& tree : forest.trees) {
    trees.push_back(tree_facts(tree));
    nodes += tree.nodes.size();
    leaves += tree.leaves.size();
  }
  const FeatureConvention& c = forest.convention;
  return {{"background_class", forest.has_background},
          {"distributions", has_distributions(forest)},
          {"headings", forest.headings},
          {"features",
           {{"offset_unit_px_m", c.offset_unit},
            {"reference_focal_px", c.reference_focal_px},
            {"hole_mm", c.hole_mm},
            {"outside_mm", c.outside_mm},
            {"clip_mm", c.clip_mm}}},
          {"nodes", nodes},
          {"leaves", leaves},
          {"bytes_per_node", bytes_per_node(size_bytes, nodes)},
          {"trees", std::move(trees)}};
}

Json model_facts(const std::string& path) {
  const std::string bytes = read_file(path);
  const Model model = parse_model(bytes, path);
  Json facts{{"model", path},
             {"size_bytes", bytes.size()},
             {"checksum", model_checksum(bytes)},
             {"sections", section_facts(model_version(bytes) == kModelVersion ? split_sections(bytes, path)
                                                                              : std::vector<ModelSection>())},
             {"recipe", labeller_recipe(model)},
             {"body", body_facts(model.body)},
             {"context_trees", model.context.trees.size()},
             {"judge_trees", model.judge.trees.size()}};
  facts.update(model.network != nullptr ? network_facts(*model.network) : forest_facts(model.forest, bytes.size()));
  return facts;
}

bool is_model(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".model" || extension == ".forest") return true;
  std::array<char, 16> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  return model_version({begin.data(), begin.size()}) != 0;
}

Json source_facts(const std::string& uri, const FrameSource& source) {
  Json holds = Json::array();
  for (const SourceItem& item : source.contents()) {
    holds.push_back({{"name", item.name},
                     {"holds", item.holds},
                     {"count", item.count < 0 ? Json() : Json(item.count)},
                     {"use", item.use.empty() ? "not taken" : item.use},
                     {"why", item.why}});
  }
  return {{"source", uri},
          {"frames", source.size() < 0 ? Json() : Json(source.size())},
          {"sequence", source.is_sequence()},
          {"holds", std::move(holds)},
          {"notes", source.notes()}};
}

std::string source_text(const std::string& uri, const FrameSource& source) {
  const std::string frames = source.size() < 0 ? "frames" : counted(source.size(), "frame");
  std::string text = fmt::format("{}: {}, {}\n{}", uri, frames,
                                 source.is_sequence() ? "with times: people are followed" : "without times",
                                 to_text(source.contents()));
  for (const std::string& note : source.notes()) text += "note: " + note + "\n";
  return text;
}

std::string as_text(const Json& facts) { return facts.dump(2, ' ', true, Json::error_handler_t::replace) + "\n"; }

std::string plain(const Json& value) {
  if (value.is_string()) return escaped(value.get<std::string>());
  if (!value.is_object()) return value.dump();
  std::string text;
  for (const auto& [key, inner] : value.items()) text += (text.empty() ? "" : ", ") + escaped(key) + " " + plain(inner);
  return text;
}

/// Appends "key: value" lines. Inner objects are indented, and lists of words are on one line.
void append_text(std::string& text, const Json& object, const std::string& indent) {
  for (const auto& [key, value] : object.items()) {
    text += indent + key + ":";
    if (value.is_object()) {
      text += '\n';
      append_text(text, value, indent + "  ");
      continue;
    }
    if (value.is_array()) {
      for (const Json& item : value) text += (item.is_object() ? "\n" + indent + "  " : " ") + plain(item);
    } else {
      text += " " + plain(value);
    }
    text += '\n';
  }
}

}  // namespace

void add_info(CLI::App& program) {
  CLI::App* command = program.add_subcommand("info", "Describe this build, a model, or what a source of frames holds");
  const auto what = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  command->add_option("FILE", *what, "Model file, or a SOURCE as of detect; without it the build is described");
  command->add_flag("--json", *json, "As JSON");
  command->callback([what, json] {
    if (!what->empty() && !is_model(*what)) {
      const std::unique_ptr<FrameSource> source = open_source(*what);
      return print(*json ? as_text(source_facts(*what, *source)) : source_text(*what, *source));
    }
    const Json facts = what->empty() ? program_facts() : model_facts(*what);
    std::string text;
    if (!*json) append_text(text, facts, "");
    print(*json ? as_text(facts) : text);
  });
}

}  // namespace vesalius::cli
