#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "evaluation/evaluate_set.h"

namespace vesalius {

/// Writes report.html, report.json and figures.csv into a folder (make_report_folder). Throws Error with the path that
/// cannot be written.
void write_report(const Evaluation& evaluation, const std::string& folder);

/// The metrics that a report shows at its top, of the sets that have them.
inline constexpr std::array kOverview{Metric::people_found,
                                      Metric::people_false,
                                      Metric::empty_with_person,
                                      Metric::mask_iou_where_found,
                                      Metric::parts_right,
                                      Metric::given_right,
                                      Metric::sides_swapped,
                                      Metric::yaw_right,
                                      Metric::pixel_person_iou,
                                      Metric::pixel_mean_recall,
                                      Metric::pixel_mean_recall_inside,
                                      Metric::body_on_empty,
                                      Metric::joints_at_10cm,
                                      Metric::joints_error,
                                      Metric::centres_at_10cm,
                                      Metric::track_mota,
                                      Metric::track_ids,
                                      Metric::track_idf1,
                                      Metric::track_hota,
                                      Metric::joints_jitter,
                                      Metric::joints_true_jitter,
                                      Metric::bones_error,
                                      Metric::stance_right};
static_assert(std::ranges::is_sorted(kOverview));

/// Returns "12.3 frames/s".
std::string speed_text(const SetResult& set);

/// Returns a summary of a set for a terminal, of at most ten lines: what was measured of people, masks, parts, joints,
/// labels and ids, in words. All metrics are in the report.
std::string summary_lines(const SetResult& set);

}  // namespace vesalius
