#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/evaluate/evaluate_report.h"
#include "cli/text_sink.h"
#include "eval/compare_figures.h"
#include "io/files/read_file.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct StoredSet {
  std::string name;
  std::string frames_key;
  std::vector<Estimate> figures;
};

double number(const Json& json) { return json.is_null() ? kNaN : json.get<double>(); }

Estimate read_figure(const std::string& name, const Json& json) {
  Estimate estimate;
  estimate.name = name;
  estimate.value = number(json.at("value"));
  estimate.interval = {number(json.at("low")), number(json.at("high"))};
  estimate.numerator = json.at("numerator").get<double>();
  estimate.denominator = json.at("denominator").get<double>();
  const Json& replicates = json.at("replicates");
  if (replicates.size() != kReplicates) throw Error(fmt::format("{}: expected {} replicates", name, kReplicates));
  for (const Json& value : replicates) estimate.replicates.push_back(number(value));
  return estimate;
}

StoredSet read_set(const Json& json) {
  StoredSet set{json.at("name").get<std::string>(), json.at("frames_key").get<std::string>(), {}};
  for (const auto& [name, figure] : json.at("figures").items()) set.figures.push_back(read_figure(name, figure));
  return set;
}

std::vector<StoredSet> read_evaluation(const std::string& path) {
  const Json json = Json::parse(read_file(path), nullptr, false);
  if (!json.is_object() || !json.contains("vesalius_evaluation")) {
    throw Error(path + ": no evaluation, expected the report.json of `vesalius evaluate`");
  }
  try {
    const int version = json.at("vesalius_evaluation").get<int>();
    if (version != kEvaluationVersion) {
      throw Error(fmt::format("version {}, expected {}", version, kEvaluationVersion));
    }
    std::vector<StoredSet> sets;
    for (const Json& set : json.at("sets")) sets.push_back(read_set(set));
    return sets;
  } catch (const nlohmann::json::exception& e) {
    throw Error(one_line(fmt::format("{}: damaged evaluation: {}", path, e.what())));
  } catch (const Error& e) {
    throw Error(fmt::format("{}: {}", path, e.what()));
  }
}

std::string line(const Comparison& c) {
  const char* verdict = c.verdict == Comparison::Verdict::better  ? "better"
                        : c.verdict == Comparison::Verdict::worse ? "WORSE"
                                                                  : "same";
  return fmt::format("  {:<34} {:>10} -> {:>10}  {:>10} ({} to {})  {}\n", c.name,
                     figure_number(c.name, c.first, false), figure_number(c.name, c.second, false),
                     figure_number(c.name, c.difference, true), figure_number(c.name, c.interval.low, true),
                     figure_number(c.name, c.interval.high, true), verdict);
}

struct Tally {
  int better = 0;
  int worse = 0;
  int same = 0;
};

std::string compare_sets(const StoredSet& first, const StoredSet& second, bool all, Tally& tally) {
  const bool paired = first.frames_key == second.frames_key;
  std::string text = fmt::format("{}{}\n", first.name, paired ? "" : " (not the same frames: wider intervals)");
  for (const Estimate& figure : first.figures) {
    const Estimate* other = find_estimate(second.figures, figure.name);
    if (other == nullptr) continue;
    const Comparison comparison = compare(figure, *other, paired);
    tally.better += comparison.verdict == Comparison::Verdict::better ? 1 : 0;
    tally.worse += comparison.verdict == Comparison::Verdict::worse ? 1 : 0;
    const bool same = comparison.verdict == Comparison::Verdict::same;
    tally.same += same ? 1 : 0;
    if (all || !same) text += line(comparison);
  }
  return text;
}

void run(const std::string& first_path, const std::string& second_path, bool all) {
  const std::vector<StoredSet> first = read_evaluation(first_path);
  const std::vector<StoredSet> second = read_evaluation(second_path);
  Tally tally;
  std::string text;
  int common = 0;
  for (const StoredSet& set : first) {
    const auto other = std::ranges::find(second, set.name, &StoredSet::name);
    if (other == second.end()) {
      text += fmt::format("{}: only in {}\n", one_line(set.name), first_path);
      continue;
    }
    ++common;
    text += compare_sets(set, *other, all, tally);
  }
  if (common == 0) throw Error(fmt::format("{} and {} have no set in common", first_path, second_path));
  print(text + fmt::format("{} better, {} worse, {} the same (95 % intervals of the difference)\n", tally.better,
                           tally.worse, tally.same));
}

}  // namespace

void add_compare(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("compare", "Say what a second evaluation has better or worse than a first");
  const auto first = std::make_shared<std::string>();
  const auto second = std::make_shared<std::string>();
  const auto all = std::make_shared<bool>(false);
  command->add_option("FIRST", *first, "report.json of `vesalius evaluate`")->required();
  command->add_option("SECOND", *second, "The same of another model or other options")->required();
  command->add_flag("--all", *all, "Also figures that do not differ");
  command->footer(R"(
Where both saw the same frames the difference is resampled frame by frame, so that small ones show. Of twenty figures
that do not differ about one is called better or worse by chance.)");
  command->callback([first, second, all] { run(*first, *second, *all); });
}

}  // namespace vesalius::cli
