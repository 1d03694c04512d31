#include "evaluation/evaluation_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

namespace vesalius {
namespace {

/// The metrics in a set's line besides the people, if the set has them.
constexpr std::array kLine{Metric::mask_iou,
                           Metric::mask_iou_where_found,
                           Metric::part_mean_seen,
                           Metric::parts_right,
                           Metric::parts_right_upper,
                           Metric::predicted_right,
                           Metric::missing_right,
                           Metric::given_right,
                           Metric::given_mirrored,
                           Metric::given_elsewhere,
                           Metric::sides_swapped,
                           Metric::sides_order,
                           Metric::sides_order_arms,
                           Metric::yaw_right,
                           Metric::pixel_person_iou,
                           Metric::pixel_background_iou,
                           Metric::pixel_mean_recall,
                           Metric::pixel_mean_recall_inside,
                           Metric::body_on_empty,
                           Metric::joints_at_10cm,
                           Metric::joints_error,
                           Metric::joints_root_aligned_error,
                           Metric::joints_procrustes_error,
                           Metric::joints_given_right,
                           Metric::joints_given_mirrored,
                           Metric::joints_given_elsewhere,
                           Metric::joints_swapped,
                           Metric::joints_seen_at_10cm,
                           Metric::joints_seen_error,
                           Metric::joints_hidden_at_10cm,
                           Metric::joints_hidden_error,
                           Metric::centres_at_10cm};
static_assert(std::ranges::is_sorted(kLine));

/// The metrics in a second line, of people who were followed over time.
constexpr std::array kTrackLine{Metric::track_mota,    Metric::track_motp,         Metric::track_missed,
                                Metric::track_false,   Metric::track_switches,     Metric::track_fragmentations,
                                Metric::track_ids,     Metric::track_longest_gap,  Metric::track_idf1,
                                Metric::track_idp,     Metric::track_idr,          Metric::track_hota,
                                Metric::track_det_a,   Metric::track_ass_a,        Metric::track_loc_a,
                                Metric::joints_jitter, Metric::joints_true_jitter, Metric::joints_delay,
                                Metric::bones_error,   Metric::bones_spread,       Metric::stance_right};
static_assert(std::ranges::is_sorted(kTrackLine));

/// The families that have a line of their own.
constexpr std::array kFamilies{Metric::posture,
                               Metric::distance,
                               Metric::heading,
                               Metric::visible,
                               Metric::motion,
                               Metric::stature,
                               Metric::roll,
                               Metric::score_right,
                               Metric::part_seen,
                               Metric::predicted_right_confidence,
                               Metric::given_right_heading,
                               Metric::given_mirrored_heading,
                               Metric::sides_swapped_heading,
                               Metric::sides_order_heading,
                               Metric::sides_order_arms_heading,
                               Metric::yaw_right_heading,
                               Metric::yaw_right_confidence,
                               Metric::pixel_recall_inside,
                               Metric::joint_at_10cm,
                               Metric::joints_given_right_heading,
                               Metric::joints_given_mirrored_heading,
                               Metric::joints_right_confidence,
                               Metric::joints_seen_right_confidence,
                               Metric::joints_hidden_right_confidence,
                               Metric::joint_up,
                               Metric::joint_up_placed,
                               Metric::bone_error,
                               Metric::stance_given};
static_assert(std::ranges::is_sorted(kFamilies));

/// Returns e.g. "people 56 of 56, false 0".
std::string people_text(const SetResult& set, const std::vector<Estimate>& estimates) {
  std::string text;
  if (const Estimate* found = find_estimate(estimates, Metric::people_found)) {
    text += fmt::format(", people {:.0f} of {:.0f}", found->numerator, found->denominator);
  }
  if (const Estimate* wrong = find_estimate(estimates, Metric::people_false)) {
    text += fmt::format(", false {:.0f}", wrong->numerator);
  }
  if (const Estimate* empty = find_estimate(estimates, Metric::empty_with_person)) {
    text += fmt::format(", somebody in {:.0f} of {:.0f} empty", empty->numerator, empty->denominator);
  }
  if (set.failed > 0) text += fmt::format(", {} failed", set.failed);
  return text;
}

/// Returns e.g. "  parts seen, %: neck 100, l_hand 87, ...", or in mm with a sign.
std::string family_line(const std::vector<Estimate>& estimates, Metric family) {
  const bool is_share = info(family).unit == MetricUnit::share;
  std::string text;
  for (const Estimate& estimate : estimates) {
    if (estimate.id.metric != family) continue;
    const std::string value =
        is_share ? fmt::format("{:.0f}", 100.0 * estimate.value) : fmt::format("{:+.0f}", estimate.value);
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", estimate.id.parameter, value);
  }
  return text.empty() ? "" : fmt::format("  {}, {}: {}\n", info(family).title, is_share ? "%" : "mm", text);
}

/// Returns e.g. ", MOTA 71.20 %" for each of the metrics that there is.
std::string metrics_text(const std::vector<Estimate>& estimates, std::span<const Metric> metrics) {
  std::string text;
  for (const Metric metric : metrics) {
    if (const Estimate* estimate = find_estimate(estimates, metric)) {
      text += fmt::format(", {} {}", info(metric).title, metric_text(metric, estimate->value));
    }
  }
  return text;
}

}  // namespace

std::string speed_text(const SetResult& set) {
  return fmt::format("{:.1f} frames/s", set.frames / std::max(1e-9, set.seconds));
}

std::string summary_lines(const SetResult& set) {
  const std::vector<Estimate> estimates = set.metrics.estimates();
  std::string text = fmt::format("{}: {} frames{}", set.name, set.frames, people_text(set, estimates));
  text += metrics_text(estimates, kLine);
  text += ", " + speed_text(set) + "\n";
  if (const std::string tracks = metrics_text(estimates, kTrackLine); !tracks.empty()) {
    text += "  over time: " + tracks.substr(2) + "\n";
  }
  for (const Metric family : kFamilies) text += family_line(estimates, family);
  return text;
}

}  // namespace vesalius
