#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/evaluate/evaluate_report.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

struct Shown {
  const char* name;
  const char* label;
};
/// The figures of a set's line, where it has them.
constexpr std::array<Shown, 14> kLine{{{"mask.iou_where_found", "mask IoU"},
                                       {"mask.iou", "with misses"},
                                       {"pixels.person_iou", "person IoU"},
                                       {"pixels.background_iou", "background IoU"},
                                       {"pixels.mean_recall", "mAcc"},
                                       {"pixels.mean_recall_inside", "mAcc among parts"},
                                       {"pixels.body_on_empty", "body on empty"},
                                       {"parts.right", "visible parts right"},
                                       {"parts.right_upper", "upper"},
                                       {"joints.at_10cm", "joints at 10 cm"},
                                       {"joints.error_m", "mean error"},
                                       {"joints.root_aligned_error_m", "root-aligned"},
                                       {"joints.procrustes_error_m", "Procrustes"},
                                       {"part.mean_seen", "parts seen"}}};

/// "people 56 of 56, false 0".
std::string people_text(const SetResult& set, const std::vector<Estimate>& estimates) {
  std::string text;
  if (const Estimate* found = find_estimate(estimates, "people.found")) {
    text += fmt::format(", people {:.0f} of {:.0f}", found->numerator, found->denominator);
  }
  if (const Estimate* wrong = find_estimate(estimates, "people.false"))
    text += fmt::format(", false {:.0f}", wrong->numerator);
  if (const Estimate* empty = find_estimate(estimates, "frames.empty_with_person")) {
    text += fmt::format(", somebody in {:.0f} of {:.0f} empty", empty->numerator, empty->denominator);
  }
  if (set.failed > 0) text += fmt::format(", {} failed", set.failed);
  return text;
}

/// "  seen: neck 100, l_hand 87, ... %": all figures of a prefix, in per cent.
std::string group_line(const std::vector<Estimate>& estimates, const std::string& title, std::string_view prefix,
                       std::string_view suffix) {
  std::string text;
  for (const Estimate& estimate : estimates) {
    if (!estimate.name.starts_with(prefix) || !estimate.name.ends_with(suffix)) continue;
    const std::string name = estimate.name.substr(prefix.size(), estimate.name.size() - prefix.size() - suffix.size());
    text += fmt::format("{}{} {:.0f}", text.empty() ? "" : ", ", name, 100.0 * estimate.value);
  }
  return text.empty() ? "" : fmt::format("  {}, %: {}\n", title, text);
}

}  // namespace

std::string figure_number(const std::string& name, double value, bool sign) {
  const bool plain = kind_of(name).metres || name == "people.false";
  const double scaled = plain ? value : 100.0 * value;
  const int digits = plain ? 3 : 2;
  const std::string text = sign ? fmt::format("{:+.{}f}", scaled, digits) : fmt::format("{:.{}f}", scaled, digits);
  return text + (kind_of(name).metres ? " m" : plain ? "" : " %");
}

std::string figure_text(const Estimate& estimate) {
  if (kind_of(estimate.name).metres) return fmt::format("{:.3f} m", estimate.value);
  if (estimate.name == "people.false") return fmt::format("{:.3f} a frame", estimate.value);
  return fmt::format("{:.2f} %", 100.0 * estimate.value);
}

std::string figure_with_interval(const Estimate& estimate) {
  const bool plain = kind_of(estimate.name).metres || estimate.name == "people.false";
  const double scale = plain ? 1.0 : 100.0;
  const int digits = plain ? 3 : 2;
  return fmt::format("{} ({:.{}f} to {:.{}f})", figure_text(estimate), scale * estimate.interval.low, digits,
                     scale * estimate.interval.high, digits);
}

std::string csv_field(std::string text) {
  std::ranges::replace(text, ',', ';');
  return text;
}

std::string speed_text(const SetResult& set) {
  if (!set.ablation.empty()) return fmt::format("{:.1f} ms a frame", set.frame_ms);
  return fmt::format("{:.1f} frames/s", set.frames / std::max(1e-9, set.seconds));
}

std::string summary_lines(const SetResult& set) {
  const std::vector<Estimate> estimates = set.figures.estimates();
  std::string text = fmt::format("{}: {} frames{}", set.name, set.frames, people_text(set, estimates));
  for (const Shown& shown : kLine) {
    if (const Estimate* estimate = find_estimate(estimates, shown.name)) {
      text += fmt::format(", {} {}", shown.label, figure_text(*estimate));
    }
  }
  text += ", " + speed_text(set) + "\n";
  text += group_line(estimates, "parts seen", "part.seen.", "");
  text += group_line(estimates, "found by posture", "posture.", "");
  text += group_line(estimates, "found by distance", "distance.", "");
  text += group_line(estimates, "found by heading", "heading.", "");
  text += group_line(estimates, "found by parts visible", "visible.", "");
  text += group_line(estimates, "found by camera motion", "motion.", "");
  text += group_line(estimates, "joints at 10 cm", "joint.", ".at_10cm");
  text += group_line(estimates, "recall of parts", "pixels.recall_inside.", "");
  return text;
}

}  // namespace vesalius::cli
