#include "evaluation/ablation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "metrics/compare_metrics.h"

namespace vesalius {
namespace {

/// The metrics of the table if the set has them. Either parts seen or parts right is enough.
constexpr std::array kColumns{
    Metric::people_found,   Metric::people_false, Metric::empty_with_person,        Metric::mask_iou,
    Metric::part_mean_seen, Metric::parts_right,  Metric::pixel_mean_recall_inside, Metric::joints_at_10cm};
static_assert(std::ranges::is_sorted(kColumns));

std::vector<Metric> columns_of(const std::vector<Estimate>& estimates) {
  std::vector<Metric> columns;
  const bool has_truth_of_parts = find_estimate(estimates, Metric::parts_right) != nullptr;
  for (const Metric metric : kColumns) {
    const bool doubled = metric == Metric::part_mean_seen && has_truth_of_parts;
    if (!doubled && find_estimate(estimates, metric) != nullptr) columns.push_back(metric);
  }
  return columns;
}

/// Returns the difference with its interval, and a star if the interval does not contain 0.
std::string difference_text(const Comparison& c) {
  const Metric metric = c.id.metric;
  return fmt::format("{} ({} to {}){}", metric_difference_text(metric, c.difference),
                     metric_difference_text(metric, c.interval.low), metric_difference_text(metric, c.interval.high),
                     c.verdict == Comparison::Verdict::same ? "" : " *");
}

std::string time_text(const SetResult& set, const AblationRow& row) {
  return fmt::format("{:.1f} ms, {:.2f} of it", row.frame_ms, row.frame_ms / std::max(1e-9, set.frame_ms));
}

}  // namespace

void add_ablation(const SetResult& set, Document& document) {
  if (set.ablation.empty()) return;
  const std::vector<Estimate> whole = set.metrics.estimates();
  const auto columns = columns_of(whole);
  std::vector<std::string> header{"variant"};
  std::vector<std::vector<std::string>> rows{{"as it is"}};
  for (const Metric metric : columns) {
    header.emplace_back(info(metric).title);
    rows.front().push_back(metric_text(metric, find_estimate(whole, metric)->value));
  }
  header.emplace_back("time a frame");
  rows.front().push_back(fmt::format("{:.1f} ms", set.frame_ms));
  for (const AblationRow& row : set.ablation) {
    std::vector<std::string>& cells = rows.emplace_back(std::vector<std::string>{row.variant});
    for (const Metric metric : columns) {
      std::string& cell = cells.emplace_back();
      const Estimate* changed = find_estimate(row.metrics, metric);
      if (changed == nullptr) continue;
      const Comparison difference = compare(*find_estimate(whole, metric), *changed, true);
      cell = metric_text(metric, changed->value) + ", " + difference_text(difference);
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
  const std::vector<Estimate> whole = set.metrics.estimates();
  std::string text;
  for (const AblationRow& row : set.ablation) {
    text += fmt::format("  {:<28} {}", row.variant, time_text(set, row));
    for (const Metric metric : columns_of(whole)) {
      const Estimate* changed = find_estimate(row.metrics, metric);
      if (changed == nullptr) continue;
      const Comparison difference = compare(*find_estimate(whole, metric), *changed, true);
      text += fmt::format("; {} {}", info(metric).title, difference_text(difference));
    }
    text += "\n";
  }
  return text;
}

}  // namespace vesalius
