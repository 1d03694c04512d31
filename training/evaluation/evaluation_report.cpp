#include "evaluation/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "evaluation/evaluation_json.h"
#include "io/files/atomic_file.h"
#include "io/files/plain_text.h"
#include "report/document.h"
#include "vesalius/draw.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

constexpr std::pair kShares{0.0, 1.02};  ///< range of a plot

/// The families that are columns of a table whose rows are parts or joints.
constexpr std::array kPartColumns{Metric::part_seen,      Metric::pixel_recall,    Metric::pixel_recall_inside,
                                  Metric::centre_at_10cm, Metric::part_right_of_4, Metric::part_right_of_8};
constexpr std::array kJointColumns{Metric::joint_at_10cm, Metric::joint_error, Metric::joint_up,
                                   Metric::joint_up_placed};

std::string cell(const std::vector<Estimate>& estimates, Metric metric, const std::string& parameter = "") {
  const Estimate* found = find_estimate(estimates, metric, parameter);
  return found == nullptr ? "" : metric_text(metric, found->value);
}

void add_overview(const Evaluation& evaluation, Document& document) {
  std::vector<std::string> header{"set", "frames"};
  std::vector<std::vector<std::string>> rows;
  std::vector<std::vector<Estimate>> of_sets;
  for (const SetResult& set : evaluation.sets) {
    rows.push_back({set.name, std::to_string(set.frames)});
    of_sets.push_back(set.metrics.estimates());
  }
  for (const Metric metric : kOverview) {
    const auto has = [&](const auto& estimates) { return find_estimate(estimates, metric) != nullptr; };
    if (std::ranges::none_of(of_sets, has)) continue;
    header.emplace_back(info(metric).title);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].push_back(cell(of_sets[i], metric));
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

void add_detection_curves(const SetResult& set, const Evaluation& evaluation, Document& document) {
  if (set.log.expected == 0 || evaluation.labels_only || evaluation.tracked) return;
  const RefineOptions& refine = evaluation.options.detect.refine;
  using P = DetectionPoint;
  const int parts = evaluation.body.part_count();
  const auto over_parts = sweep_parts(set.log, parts, double(refine.min_score));
  document.plot({"Share of people found, and of their parts, by fewest parts of a person",
                 "fewest parts",
                 "rate",
                 {series("people", over_parts, &P::threshold, &P::rate),
                  series("parts", over_parts, &P::threshold, &P::part_rate),
                  series("upper parts", over_parts, &P::threshold, &P::upper_part_rate),
                  series("false a frame", over_parts, &P::threshold, &P::false_per_frame)},
                 std::pair{0.0, double(parts)},
                 kShares});
  const auto over_score = sweep_score(set.log, kScoreSteps, refine.min_parts);
  document.plot({"People found against false people a frame, over the score",
                 "false people a frame",
                 "people found",
                 {series("score swept", over_score, &P::false_per_frame, &P::rate)},
                 {},
                 kShares});
}

/// Adds how often each part of people found is right, as the paper's Figs 10 and 11.
void add_part_bars(const std::vector<Estimate>& estimates, const BodyModel& body, Document& document) {
  BarPlot plot{"Share of people found, among those on whom the part is visible, that have it right", {}, {}};
  for (const BodyPart& part : body.parts) plot.names.push_back(part.name);
  for (const auto& [metric, name] : {std::pair{Metric::part_right_of_4, "found with at least 4 parts"},
                                     std::pair{Metric::part_right_of_8, "with at least 8"}}) {
    std::vector<double> shares;
    for (const std::string& part : plot.names) {
      const Estimate* estimate = find_estimate(estimates, metric, part);
      shares.push_back(estimate != nullptr ? estimate->value : std::numeric_limits<double>::quiet_NaN());
    }
    const auto known = [](double share) { return !std::isnan(share); };
    if (std::ranges::any_of(shares, known)) plot.series.emplace_back(name, std::move(shares));
  }
  if (!plot.series.empty()) document.bars(plot);
}

/// Adds how many of the joints given out with each confidence are right: on the diagonal it means what it says.
void add_reliability(const std::vector<Estimate>& estimates, Document& document) {
  LinePlot plot{"Share of joints that are right by the confidence they were given with",
                "confidence",
                "share within 10 cm",
                {},
                kShares,
                kShares};
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
  document.plot(plot);
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
  rows.push_back({"mean", fmt::format("{:.1f} %", 100.0 * sum / double(averages.size()))});
  document.paragraph(fmt::format("Average precision of the {}s of all people proposed, within 10 cm:", what));
  document.table({what, "average precision"}, rows);
}

/// Adds for each class that occurs what its pixels are taken for.
void add_confusion(const PixelConfusion& confusion, const BodyModel& body, Document& document) {
  MatrixPlot matrix{"Percent of the pixels of a true class (row) that were given a class (column)", {}, {}};
  for (const BodyPart& part : body.parts) matrix.names.push_back(part.name);
  matrix.names.emplace_back("background");
  for (int truth = 0; truth <= body.part_count(); ++truth) {
    const auto all = double(std::max(confusion.of_truth(truth), std::uint64_t{1}));
    std::vector<double>& row = matrix.shares.emplace_back();
    for (int given = 0; given <= body.part_count(); ++given) {
      row.push_back(double(confusion.count(truth, given)) / all);
    }
  }
  document.matrix(matrix);
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
  document.paragraph(fmt::format("{} of {}{}, {}.", counted(set.frames, "frame"), set.source,
                                 set.failed > 0 ? fmt::format(" ({} more failed)", set.failed) : "", speed_text(set)));
  for (const std::string& note : set.notes) document.paragraph("Note: " + note);
  for (const std::string& failure : set.failures) document.paragraph("Failed: " + failure);
  for (const WorstFrame& worst : set.worst) {
    document.picture(
        encode_png(picture_of(worst, evaluation.body)),
        fmt::format("{}: {}.{}", worst.frame.name, worst.score.what_went_wrong,
                    worst.score.labels.empty() ? "" : " Left: what was found; right: labels of the first pass."));
  }
  const std::vector<Estimate> estimates = set.metrics.estimates();
  add_tables(estimates, document);
  add_detection_curves(set, evaluation, document);
  add_part_bars(estimates, evaluation.body, document);
  add_reliability(estimates, document);
  add_precision(set.joint_precision, "joint", document);
  add_precision(set.centre_precision, "part's centre", document);
  if (set.confusion) add_confusion(*set.confusion, evaluation.body, document);
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

/// One line of a summary: a word, and after it phrases about the metrics that the set has.
class SummaryLine {
 public:
  SummaryLine(const std::vector<Estimate>& estimates, std::string_view word) : estimates_(estimates), word_(word) {}

  /// Adds what `phrase`, a format of one text, says of a metric; the first of a line with its interval.
  SummaryLine& add(Metric metric, fmt::format_string<std::string> phrase) {
    if (const Estimate* estimate = find_estimate(estimates_, metric)) {
      add(fmt::format(phrase, has_interval_ ? metric_text(metric, estimate->value) : text_with_interval(*estimate)));
      has_interval_ = true;
    }
    return *this;
  }

  /// Adds what `phrase`, a format of two numbers, says of the counts of a metric.
  SummaryLine& add_counts(Metric metric, fmt::format_string<const double&, const double&> phrase) {
    if (const Estimate* estimate = find_estimate(estimates_, metric)) {
      add(fmt::format(phrase, estimate->numerator, estimate->denominator));
    }
    return *this;
  }

  /// Returns the line, or nothing if the set has none of the metrics.
  std::string text() const { return text_.empty() ? "" : fmt::format("  {:<9} {}\n", word_, text_); }

 private:
  void add(const std::string& phrase) { text_ += (text_.empty() ? "" : ", ") + phrase; }

  const std::vector<Estimate>& estimates_;
  std::string_view word_;
  std::string text_;
  bool has_interval_ = false;
};

}  // namespace

void write_report(const Evaluation& evaluation, const std::string& folder) {
  const std::filesystem::path path(folder);
  write_report_page(make_document(evaluation), folder);
  write_file_atomically((path / "figures.csv").string(), evaluation_csv(evaluation));
  write_file_atomically((path / "report.json").string(), evaluation_json(evaluation) + "\n");
}

std::string speed_text(const SetResult& set) {
  return fmt::format("{:.1f} frames/s", set.frames / std::max(1e-9, set.seconds));
}

std::string summary_lines(const SetResult& set) {
  const std::vector<Estimate> estimates = set.metrics.estimates();
  const auto line = [&](std::string_view word) { return SummaryLine(estimates, word); };
  using M = Metric;
  return fmt::format("{}: {}{}, {}\n", set.name, counted(set.frames, "frame"),
                     set.failed > 0 ? fmt::format(", {} failed", set.failed) : "", speed_text(set)) +
         line("found").add_counts(M::people_found, "{:.0f} of {:.0f} people").add(M::people_found, "{}").text() +
         line("false").add_counts(M::people_false, "{:.0f}").add(M::people_false, "{}").text() +
         line("empty").add_counts(M::empty_with_person, "somebody in {:.0f} of {:.0f} frames without people").text() +
         line("masks").add(M::mask_iou_where_found, "{} overlap with the true ones (IoU)").text() +
         line("parts")
             .add(M::given_right, "{} of those given out are right")
             .add(M::sides_swapped, "left and right swapped on {} of people")
             .text() +
         line("heading").add(M::yaw_right, "{} within 45 degrees").text() +
         line("joints").add(M::joints_at_10cm, "{} within 10 cm").add(M::joints_error, "{} off on average").text() +
         line("labels")
             .add(M::pixel_person_iou, "{} overlap with people (IoU)")
             .add(M::pixel_mean_recall, "{} of a part's pixels right")
             .add(M::body_on_empty, "{} of empty frames taken for people")
             .text() +
         line("ids")
             .add(M::track_idf1, "IDF1 {}")
             .add(M::track_hota, "HOTA {}")
             .add(M::track_mota, "MOTA {}")
             .add(M::track_ids, "ids {}")
             .text() +
         line("postures").add(M::stance_right, "{} right").text();
}

}  // namespace vesalius
