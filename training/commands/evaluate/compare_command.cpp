#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "commands/training_commands.h"
#include "console/text_sink.h"
#include "evaluation/compare_evaluations.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

std::string line(const Comparison& c) {
  const Metric metric = c.id.metric;
  const bool worse = c.verdict == Comparison::Verdict::worse;
  return fmt::format("  {:<34} {:>10} -> {:>10}  {:>10} ({} to {})  {}\n", c.id.name(), metric_text(metric, c.first),
                     metric_text(metric, c.second), metric_difference_text(metric, c.difference),
                     metric_difference_text(metric, c.interval.low), metric_difference_text(metric, c.interval.high),
                     worse ? "WORSE" : verdict_word(c.verdict));
}

void run(const std::string& first, const std::string& second, bool all) {
  const std::vector<SetComparison> sets = compare_evaluations(read_evaluation(first), read_evaluation(second));
  if (std::ranges::none_of(sets, &SetComparison::in_both)) {
    throw Error(fmt::format("{} and {} have no set in common", first, second));
  }
  std::string text;
  std::array<int, 3> tally{};  // number of metrics for each verdict
  for (const SetComparison& set : sets) {
    if (!set.in_both) {
      text += fmt::format("{}: only in {}\n", one_line(set.name), first);
      continue;
    }
    text += one_line(set.name) + (set.paired ? "\n" : " (not the same frames: wider intervals)\n");
    for (const Comparison& comparison : set.metrics) {
      ++tally[static_cast<std::size_t>(comparison.verdict)];
      if (all || comparison.verdict != Comparison::Verdict::same) text += line(comparison);
    }
  }
  print(text + fmt::format("{} better, {} worse, {} the same (95 % intervals of the difference)\n", tally[0], tally[1],
                           tally[2]));
}

}  // namespace

void add_compare(CLI::App& program) {
  CLI::App* command = program.add_subcommand("compare", "Compare two evaluations metric by metric");
  const auto first = std::make_shared<std::string>();
  const auto second = std::make_shared<std::string>();
  const auto all = std::make_shared<bool>(false);
  command->add_option("FIRST", *first, "report.json of `vesalius evaluate`")->required();
  command->add_option("SECOND", *second, "The same for another model or other options")->required();
  command->add_flag("--all", *all, "Print also metrics that do not differ");
  command->footer(R"(
If both evaluations saw the same frames, differences are resampled frame by frame, which shows even small ones. About one
in twenty metrics without a difference is called better or worse by chance.)");
  command->callback([first, second, all] { run(*first, *second, *all); });
}

}  // namespace vesalius::cli
