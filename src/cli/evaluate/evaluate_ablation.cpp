#include "cli/evaluate/evaluate_ablation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cli/evaluate/evaluate_report.h"
#include "cli/json_number.h"
#include "eval/compare_figures.h"

namespace vesalius::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Figures of the table, where the set has them; of the last two that tell of parts the first.
constexpr std::array<std::pair<const char*, const char*>, 8> kColumns{
    {{"people.found", "people found"},
     {"people.false", "false people"},
     {"frames.empty_with_person", "empty frames with somebody"},
     {"mask.iou", "mask IoU"},
     {"joints.at_10cm", "joints at 10 cm"},
     {"pixels.mean_recall_inside", "mAcc among parts"},
     {"parts.right", "visible parts right"},
     {"part.mean_seen", "parts seen"}}};

/// Columns for which the set has figures.
std::vector<std::pair<const char*, const char*>> columns_of(const std::vector<Estimate>& figures) {
  std::vector<std::pair<const char*, const char*>> columns;
  for (const auto& column : kColumns) {
    const bool doubled =
        std::string_view(column.first) == "part.mean_seen" && find_estimate(figures, "parts.right") != nullptr;
    if (find_estimate(figures, column.first) != nullptr && !doubled) columns.push_back(column);
  }
  return columns;
}

/// The difference with its interval, and a star where that does not hold 0.
std::string difference_text(const Comparison& c) {
  return fmt::format("{} ({} to {}){}", figure_number(c.name, c.difference, true),
                     figure_number(c.name, c.interval.low, true), figure_number(c.name, c.interval.high, true),
                     c.verdict == Comparison::Verdict::same ? "" : " *");
}

/// One comparison for each figure that both have; both saw the same frames.
std::vector<Comparison> comparisons(const std::vector<Estimate>& whole, const AblationRow& row) {
  std::vector<Comparison> all;
  for (const Estimate& figure : row.figures) {
    if (const Estimate* before = find_estimate(whole, figure.name)) all.push_back(compare(*before, figure, true));
  }
  return all;
}

std::string time_text(const SetResult& set, const AblationRow& row) {
  return fmt::format("{:.1f} ms, {:.2f} of it", row.frame_ms, row.frame_ms / std::max(1e-9, set.frame_ms));
}

const char* to_string(Comparison::Verdict verdict) {
  return verdict == Comparison::Verdict::better ? "better" : verdict == Comparison::Verdict::worse ? "worse" : "same";
}

}  // namespace

void add_ablation(const SetResult& set, Document& document) {
  if (set.ablation.empty()) return;
  const std::vector<Estimate> whole = set.figures.estimates();
  const auto columns = columns_of(whole);
  std::vector<std::string> header{"variant"};
  std::vector<std::vector<std::string>> rows{{"as it is"}};
  for (const auto& [name, title] : columns) {
    header.emplace_back(title);
    rows.front().push_back(figure_text(*find_estimate(whole, name)));
  }
  header.emplace_back("time a frame");
  rows.front().push_back(fmt::format("{:.1f} ms", set.frame_ms));
  for (const AblationRow& row : set.ablation) {
    std::vector<std::string>& cells = rows.emplace_back(std::vector<std::string>{row.variant});
    for (const auto& [name, title] : columns) {
      const Estimate* figure = find_estimate(row.figures, name);
      cells.push_back(figure == nullptr
                          ? ""
                          : fmt::format("{}, {}", figure_text(*figure),
                                        difference_text(compare(*find_estimate(whole, name), *figure, true))));
    }
    cells.push_back(time_text(set, row));
  }
  document.paragraph(
      "What each part of the method is worth here: the same frames with one thing changed, the difference to the first "
      "row with its interval (* where that does not hold 0), and the median time of the detector on a frame.");
  document.table(header, rows);
}

std::string ablation_lines(const SetResult& set) {
  if (set.ablation.empty()) return "";
  const std::vector<Estimate> whole = set.figures.estimates();
  std::string text;
  for (const AblationRow& row : set.ablation) {
    text += fmt::format("  {:<28} {}", row.variant, time_text(set, row));
    for (const auto& [name, title] : columns_of(whole)) {
      const Estimate* figure = find_estimate(row.figures, name);
      if (figure == nullptr) continue;
      text += fmt::format("; {} {}", title, difference_text(compare(*find_estimate(whole, name), *figure, true)));
    }
    text += "\n";
  }
  return text;
}

std::string ablation_csv(const std::vector<SetResult>& sets) {
  std::string csv = "set,variant,figure,value,difference,low,high,verdict\n";
  for (const SetResult& set : sets) {
    if (set.ablation.empty()) continue;
    const std::string name = csv_field(set.name);
    const std::vector<Estimate> whole = set.figures.estimates();
    for (const Estimate& e : whole) csv += fmt::format("{},,{},{:.6g},,,,\n", name, e.name, e.value);
    csv += fmt::format("{},,frame_ms,{:.6g},,,,\n", name, set.frame_ms);
    for (const AblationRow& row : set.ablation) {
      const std::string variant = csv_field(row.variant);
      for (const Comparison& c : comparisons(whole, row)) {
        csv += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", name, variant, c.name, c.second, c.difference,
                           c.interval.low, c.interval.high, to_string(c.verdict));
      }
      csv += fmt::format("{},{},frame_ms,{:.6g},{:.6g},,,\n", name, variant, row.frame_ms, row.frame_ms - set.frame_ms);
    }
  }
  return csv;
}

Json ablation_json(const SetResult& set) {
  const std::vector<Estimate> whole = set.figures.estimates();
  Json rows = Json::array();
  for (const AblationRow& row : set.ablation) {
    Json figures = Json::object();
    for (const Comparison& c : comparisons(whole, row)) {
      figures[c.name] = {{"value", json_number(c.second)},
                         {"difference", json_number(c.difference)},
                         {"low", json_number(c.interval.low)},
                         {"high", json_number(c.interval.high)},
                         {"verdict", to_string(c.verdict)}};
    }
    rows.push_back({{"variant", row.variant},
                    {"frame_ms", row.frame_ms},
                    {"frame_ms_as_it_is", set.frame_ms},
                    {"figures", std::move(figures)}});
  }
  return rows;
}

}  // namespace vesalius::cli
