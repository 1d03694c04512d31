#include "evaluation/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

#include "draw/draw.h"
#include "evaluation/evaluation_csv.h"
#include "evaluation/evaluation_json.h"
#include "evaluation/evaluation_summary.h"
#include "io/files/atomic_file.h"
#include "io/files/image_file.h"
#include "report/document.h"
#include "report/plot.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

/// The metrics of the table at the top.
constexpr std::array kOverview{
    Metric::people_found,         Metric::people_false,      Metric::empty_with_person,
    Metric::mask_iou_where_found, Metric::given_right,       Metric::sides_swapped,
    Metric::pixel_person_iou,     Metric::pixel_mean_recall, Metric::pixel_mean_recall_inside,
    Metric::body_on_empty,        Metric::joints_at_10cm};
/// Those that follow where people were followed over time.
constexpr std::array kTrackOverview{Metric::track_mota,    Metric::track_idf1,         Metric::track_hota,
                                    Metric::joints_jitter, Metric::joints_true_jitter, Metric::joints_delay};
static_assert(std::ranges::is_sorted(kOverview));

/// The families that are columns of a table whose rows are parts or joints.
constexpr std::array kPartColumns{Metric::part_seen, Metric::pixel_recall, Metric::pixel_recall_inside,
                                  Metric::centre_at_10cm, Metric::centre_error};
constexpr std::array kJointColumns{Metric::joint_at_10cm,   Metric::joint_error, Metric::joint_up,
                                   Metric::joint_up_placed, Metric::joint_left,  Metric::joint_behind};

std::string cell(const std::vector<Estimate>& estimates, Metric metric, const std::string& parameter = "") {
  const Estimate* found = find_estimate(estimates, metric, parameter);
  return found == nullptr ? "" : metric_text(metric, found->value);
}

void add_overview(const Evaluation& evaluation, Document& document) {
  std::vector<Metric> columns(kOverview.begin(), kOverview.end());
  if (evaluation.tracked) columns.insert(columns.end(), kTrackOverview.begin(), kTrackOverview.end());
  std::vector<std::string> header{"set", "frames"};
  for (const Metric metric : columns) header.emplace_back(info(metric).title);
  std::vector<std::vector<std::string>> rows;
  for (const SetResult& set : evaluation.sets) {
    const std::vector<Estimate> estimates = set.metrics.estimates();
    std::vector<std::string>& row = rows.emplace_back();
    row = {set.name, std::to_string(set.frames)};
    for (const Metric metric : columns) row.push_back(cell(estimates, metric));
  }
  document.heading(2, "All sets");
  document.table(header, rows);
}

/// Adds the metrics that are not columns of a table of parts or joints.
void add_metrics(const std::vector<Estimate>& estimates, Document& document) {
  std::vector<std::vector<std::string>> rows;
  for (const Estimate& e : estimates) {
    const auto is_it = [&](Metric column) { return column == e.id.metric; };
    if (std::ranges::any_of(kPartColumns, is_it) || std::ranges::any_of(kJointColumns, is_it)) continue;
    const bool counts = info(e.id.metric).kind == MetricKind::trials;
    rows.push_back({e.id.name(), text_with_interval(e),
                    counts ? fmt::format("{:.0f} of {:.0f}", e.numerator, e.denominator) : ""});
  }
  document.table({"metric", "value (95 % interval)", "counts"}, rows);
}

/// Adds a table with a row for each part or joint and a column for each family that has any.
void add_family_table(const std::vector<Estimate>& estimates, const std::string& first_column,
                      std::span<const Metric> families, Document& document) {
  std::vector<std::string> header{first_column};
  std::vector<std::vector<std::string>> rows;
  std::vector<Metric> columns;
  for (const Metric family : families) {
    for (const Estimate& e : estimates) {
      if (e.id.metric != family) continue;
      if (columns.empty() || columns.back() != family) columns.push_back(family);
      const std::string& member = e.id.parameter;
      if (std::ranges::none_of(rows, [&](const auto& row) { return row[0] == member; })) rows.push_back({member});
    }
  }
  for (const Metric family : columns) {
    header.emplace_back(info(family).title);
    for (auto& row : rows) row.push_back(cell(estimates, family, row[0]));
  }
  if (!rows.empty()) document.table(header, rows);
}

void add_tables(const std::vector<Estimate>& estimates, Document& document) {
  add_metrics(estimates, document);
  add_family_table(estimates, "part", kPartColumns, document);
  add_family_table(estimates, "joint", kJointColumns, document);
}

PlotSeries series(const std::string& name, const std::vector<DetectionPoint>& curve, double DetectionPoint::*x,
                  double DetectionPoint::*y) {
  PlotSeries result{name, {}};
  for (const DetectionPoint& point : curve) result.points.emplace_back(point.*x, point.*y);
  return result;
}

void add_plot(const LinePlot& plot, const std::string& name, const std::string& caption, Document& document) {
  const auto is_finite = [](const auto& point) { return std::isfinite(point.first) && std::isfinite(point.second); };
  const auto has_points = [&](const PlotSeries& s) { return std::ranges::any_of(s.points, is_finite); };
  if (std::ranges::any_of(plot.series, has_points)) document.svg(name, plot_svg(plot), caption);
}

void add_detection_curves(const SetResult& set, const Evaluation& evaluation, Document& document) {
  if (set.log.expected == 0 || evaluation.labels_only || evaluation.tracked) return;
  const RefineOptions& refine = evaluation.options.detect.refine;
  using P = DetectionPoint;
  const int parts = evaluation.body.part_count();
  const auto over_parts = sweep_parts(set.log, parts, static_cast<double>(refine.min_score));
  LinePlot plot;
  plot.title = set.name + ": against the number of parts";
  plot.x_label = "fewest parts";
  plot.y_label = "rate";
  plot.x_range = PlotRange{0.0, static_cast<double>(parts)};
  plot.y_range = PlotRange{0.0, 1.02};
  plot.series = {series("people", over_parts, &P::threshold, &P::rate),
                 series("parts", over_parts, &P::threshold, &P::part_rate),
                 series("upper parts", over_parts, &P::threshold, &P::upper_part_rate),
                 series("false a frame", over_parts, &P::threshold, &P::false_per_frame)};
  add_plot(plot, set.name + "_parts", "Share of people found, and of their parts, by fewest parts of a person",
           document);
  const auto over_score = sweep_score(set.log, kScoreSteps, refine.min_parts);
  LinePlot recall;
  recall.title = set.name + ": people found against false people";
  recall.x_label = "false people a frame";
  recall.y_label = "people found";
  recall.y_range = PlotRange{0.0, 1.02};
  recall.series = {series("score swept", over_score, &P::false_per_frame, &P::rate)};
  add_plot(recall, set.name + "_score", "People found against false people a frame, over the score", document);
}

void add_joint_curve(const SetResult& set, Document& document) {
  if (set.joint_curve.joints == 0) return;
  LinePlot plot;
  plot.title = set.name + ": joints within a distance";
  plot.x_label = "distance, cm";
  plot.y_label = "share of joints";
  plot.x_range = PlotRange{0.0, static_cast<double>(kJointCurve_cm)};
  plot.y_range = PlotRange{0.0, 1.02};
  PlotSeries& line = plot.series.emplace_back(PlotSeries{"all joints", {{0.0, 0.0}}});
  for (int cm = 1; cm <= kJointCurve_cm; ++cm) line.points.emplace_back(cm, set.joint_curve.share(cm));
  add_plot(plot, set.name + "_joints", "Share of joints within a distance of the truth", document);
}

/// Adds how many of the joints given out with each confidence are right: on the diagonal it means what it says.
void add_reliability(const SetResult& set, const std::vector<Estimate>& estimates, Document& document) {
  LinePlot plot;
  plot.title = set.name + ": joints right by confidence";
  plot.x_label = "confidence";
  plot.y_label = "share within 10 cm";
  plot.x_range = PlotRange{0.0, 1.0};
  plot.y_range = PlotRange{0.0, 1.02};
  constexpr std::array kLines{std::pair{"all joints", Metric::joints_right_confidence},
                              std::pair{"seen", Metric::joints_seen_right_confidence},
                              std::pair{"hidden", Metric::joints_hidden_right_confidence}};
  for (const auto& [name, family] : kLines) {
    PlotSeries line{name, {}};
    for (const Estimate& e : estimates) {
      if (e.id.metric == family) line.points.emplace_back(0.1 * e.id.place + 0.05, e.value);
    }
    if (!line.points.empty()) plot.series.push_back(std::move(line));
  }
  if (plot.series.empty()) return;
  plot.series.push_back({"as it is meant", {{0.0, 0.0}, {1.0, 1.0}}});
  add_plot(plot, set.name + "_reliability", "Share of joints that are right by the confidence they were given with",
           document);
}

/// Adds the average precision of each joint, or each part's centre, over all people proposed.
void add_precision(const JointPrecision& precision, const std::string& what, Document& document) {
  const auto averages = precision.averages();
  if (averages.empty()) return;
  std::vector<std::vector<std::string>> rows;
  double sum = 0.0;
  for (const auto& [name, average] : averages) {
    rows.push_back({name, fmt::format("{:.1f} %", 100.0 * average)});
    sum += average;
  }
  rows.push_back({"mean", fmt::format("{:.1f} %", 100.0 * sum / static_cast<double>(averages.size()))});
  document.paragraph(fmt::format("Average precision of the {}s of all people proposed, within 10 cm:", what));
  document.table({what, "average precision"}, rows);
}

/// Adds for each class how many of its pixels are right, and the classes that the others are most often taken for.
void add_confusion(const PixelConfusion& confusion, const BodyModel& body, Document& document) {
  const auto name = [&](int label) {
    return label == body.part_count() ? std::string("background") : body.parts[label].name;
  };
  std::vector<std::vector<std::string>> rows;
  for (int truth = 0; truth <= body.part_count(); ++truth) {
    const auto all = static_cast<double>(confusion.of_truth(truth));
    if (all == 0.0) continue;
    std::vector<std::pair<std::uint64_t, int>> others;
    for (int given = 0; given <= body.part_count(); ++given) {
      if (given != truth) others.emplace_back(confusion.count(truth, given), given);
    }
    std::ranges::stable_sort(others, [](const auto& a, const auto& b) { return a.first > b.first; });
    std::string taken_for;
    for (std::size_t i = 0; i < 3 && others[i].first > 0; ++i) {
      taken_for += fmt::format("{}{} {:.1f} %", i > 0 ? ", " : "", name(others[i].second),
                               100.0 * static_cast<double>(others[i].first) / all);
    }
    rows.push_back(
        {name(truth), fmt::format("{:.0f}", all), fmt::format("{:.1f} %", 100.0 * confusion.recall(truth)), taken_for});
  }
  document.paragraph("Pixels by class, and what they are most often taken for:");
  document.table({"class", "pixels", "right", "taken for"}, rows);
}

/// Returns a picture of the people found beside the labels of the first pass, if there are any, which explain the
/// result.
ColourImage picture_of(const WorstFrame& worst, const BodyModel& body) {
  ColourImage people = draw_people(worst.frame, worst.score.people, body);
  if (worst.score.labels.empty()) return people;
  const ColourImage labels = draw_labels(worst.score.labels, worst.frame.depth, body, false);
  ColourImage both(people.width() + labels.width(), std::max(people.height(), labels.height()));
  for (int v = 0; v < people.height(); ++v) std::copy_n(people.row(v), people.width(), both.row(v));
  for (int v = 0; v < labels.height(); ++v) std::copy_n(labels.row(v), labels.width(), both.row(v) + people.width());
  return both;
}

void add_set(const SetResult& set, const Evaluation& evaluation, Document& document) {
  document.heading(2, set.name);
  document.paragraph(fmt::format("{} frames of {}{}, {}.", set.frames, set.source,
                                 set.failed > 0 ? fmt::format(" ({} more failed)", set.failed) : "", speed_text(set)));
  for (const std::string& note : set.notes) document.paragraph("Note: " + note);
  for (const std::string& failure : set.failures) document.paragraph("Failed: " + failure);
  const std::vector<Estimate> estimates = set.metrics.estimates();
  add_tables(estimates, document);
  add_detection_curves(set, evaluation, document);
  add_joint_curve(set, document);
  add_reliability(set, estimates, document);
  add_precision(set.joint_precision, "joint", document);
  add_precision(set.centre_precision, "part's centre", document);
  if (set.confusion) add_confusion(*set.confusion, evaluation.body, document);
  for (const WorstFrame& worst : set.worst) {
    document.picture(
        set.name + "_" + worst.frame.name, encode_png(picture_of(worst, evaluation.body)),
        fmt::format("{}: {}.{}", worst.frame.name, worst.score.what_went_wrong,
                    worst.score.labels.empty() ? "" : " Left: what was found; right: labels of the first pass."));
  }
}

Document make_document(const Evaluation& evaluation) {
  Document document("vesalius: evaluation");
  document.paragraph(fmt::format("Model {} (checksum {}), vesalius {}.", evaluation.model, evaluation.model_checksum,
                                 evaluation.version));
  document.preformatted(evaluation.command);
  document.paragraph(evaluation.machine + ".");
  document.paragraph(
      std::string("What each metric means: docs/metrics.md. Intervals are of 95 %: Wilson's for counts, the bootstrap "
                  "over ") +
      (evaluation.tracked ? "stretches of consecutive frames" : "frames") + " for all else.");
  add_overview(evaluation, document);
  for (const SetResult& set : evaluation.sets) add_set(set, evaluation, document);
  return document;
}

}  // namespace

void prepare_report(const std::string& folder) {
  const fs::path pictures = fs::path(folder) / "pictures";
  std::error_code error;
  fs::create_directories(pictures, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", pictures.string(), error.message()));
  LinePlot plot;
  plot.title = "trial";
  plot.series = {{"", {{0.0, 0.0}, {1.0, 1.0}}}};
  plot_svg(plot);
}

void write_report(const Evaluation& evaluation, const std::string& folder) {
  const fs::path path(folder);
  const Document document = make_document(evaluation);
  for (const Document::Picture& picture : document.pictures()) {
    write_file_atomically((path / "pictures" / picture.file).string(), picture.bytes);
  }
  write_file_atomically((path / "report.md").string(), document.markdown("pictures"));
  write_file_atomically((path / "report.html").string(), document.html());
  write_file_atomically((path / "figures.csv").string(), evaluation_csv(evaluation));
  write_file_atomically((path / "report.json").string(), evaluation_json(evaluation) + "\n");
}

}  // namespace vesalius
