#include "cli/evaluate/evaluate_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "cli/evaluate/evaluate_ablation.h"
#include "cli/evaluate_machine.h"
#include "draw/draw.h"
#include "io/files/atomic_file.h"
#include "io/files/image_file.h"
#include "report/document.h"
#include "report/plot.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

/// Figures of the table at the top.
constexpr std::array<std::pair<const char*, const char*>, 9> kOverview{
    {{"people.found", "people found"},
     {"people.false", "false people"},
     {"frames.empty_with_person", "empty frames with somebody"},
     {"mask.iou_where_found", "mask IoU"},
     {"pixels.person_iou", "person IoU of labels"},
     {"pixels.body_on_empty", "body on empty frames"},
     {"pixels.mean_recall", "mAcc"},
     {"pixels.mean_recall_inside", "mAcc among parts"},
     {"joints.at_10cm", "joints at 10 cm"}}};

std::string cell(const std::vector<Estimate>& estimates, std::string_view name) {
  const Estimate* found = find_estimate(estimates, name);
  return found == nullptr ? "" : figure_text(*found);
}

void add_overview(const Evaluation& evaluation, Document& document) {
  std::vector<std::string> header{"set", "frames"};
  for (const auto& [name, title] : kOverview) header.emplace_back(title);
  std::vector<std::vector<std::string>> rows;
  for (const SetResult& set : evaluation.sets) {
    const std::vector<Estimate> estimates = set.figures.estimates();
    std::vector<std::string>& row = rows.emplace_back();
    row = {set.name, std::to_string(set.frames)};
    for (const auto& [name, title] : kOverview) row.push_back(cell(estimates, name));
  }
  document.heading(2, "All sets");
  document.table(header, rows);
}

/// Figures that are no group of parts or joints.
void add_figures(const std::vector<Estimate>& estimates, Document& document) {
  std::vector<std::vector<std::string>> rows;
  for (const Estimate& e : estimates) {
    const bool group =
        e.name.starts_with("part.seen.") || e.name.starts_with("joint.") || e.name.starts_with("pixels.recall");
    if (group) continue;
    const bool counts = kind_of(e.name).trials;
    rows.push_back(
        {e.name, figure_with_interval(e), counts ? fmt::format("{:.0f} of {:.0f}", e.numerator, e.denominator) : ""});
  }
  document.table({"figure", "value (95 % interval)", "counts"}, rows);
}

/// One row for each member of groups that belong together, e.g. for each part: seen, recall.
void add_group_table(const std::vector<Estimate>& estimates, const std::string& first_column,
                     const std::vector<std::array<std::string, 3>>& groups, Document& document) {
  std::vector<std::string> members;
  for (const auto& [prefix, suffix, title] : groups) {
    for (const Estimate& e : estimates) {
      if (!e.name.starts_with(prefix) || !e.name.ends_with(suffix)) continue;
      const std::string member = e.name.substr(prefix.size(), e.name.size() - prefix.size() - suffix.size());
      if (std::ranges::find(members, member) == members.end()) members.push_back(member);
    }
  }
  if (members.empty()) return;
  std::vector<std::string> header{first_column};
  std::vector<std::vector<std::string>> rows;
  for (const std::string& member : members) rows.push_back({member});
  for (const auto& [prefix, suffix, title] : groups) {
    std::vector<std::string> column;
    bool any = false;
    for (const std::string& member : members) {
      column.push_back(cell(estimates, prefix + member + suffix));
      any = any || !column.back().empty();
    }
    if (!any) continue;
    header.push_back(title);
    for (std::size_t m = 0; m < members.size(); ++m) rows[m].push_back(column[m]);
  }
  document.table(header, rows);
}

void add_tables(const std::vector<Estimate>& estimates, Document& document) {
  add_figures(estimates, document);
  add_group_table(estimates, "part",
                  {{"part.seen.", "", "observed on true people"},
                   {"pixels.recall.", "", "recall, background a rival"},
                   {"pixels.recall_inside.", "", "recall among parts"}},
                  document);
  add_group_table(estimates, "joint", {{"joint.", ".at_10cm", "within 10 cm"}, {"joint.", ".error_m", "mean error"}},
                  document);
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
  if (set.log.expected == 0 || evaluation.labels_only) return;
  const RefineOptions& refine = evaluation.options.refine;
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

/// Average precision over all people proposed.
void add_joint_precision(const SetResult& set, Document& document) {
  const auto averages = set.joint_precision.averages();
  if (averages.empty()) return;
  std::vector<std::vector<std::string>> rows;
  double sum = 0.0;
  for (const auto& [joint, precision] : averages) {
    rows.push_back({joint, fmt::format("{:.1f} %", 100.0 * precision)});
    sum += precision;
  }
  rows.push_back({"mean", fmt::format("{:.1f} %", 100.0 * sum / static_cast<double>(averages.size()))});
  document.paragraph("Average precision of the joints of all people proposed, within 10 cm:");
  document.table({"joint", "average precision"}, rows);
}

/// The classes that a class is most often taken for.
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

/// The people found beside the labels of the first pass, which show why.
ColourImage picture_of(const WorstFrame& worst, const BodyModel& body) {
  const ColourImage people = draw_people(worst.frame, worst.score.people, body);
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
  add_tables(set.figures.estimates(), document);
  add_detection_curves(set, evaluation, document);
  add_joint_curve(set, document);
  add_joint_precision(set, document);
  add_ablation(set, document);
  if (set.confusion) add_confusion(*set.confusion, evaluation.body, document);
  for (const WorstFrame& worst : set.worst) {
    document.picture(set.name + "_" + worst.frame.name, encode_png(picture_of(worst, evaluation.body)),
                     fmt::format("{}: {}. Left: what was found; right: labels of the first pass.", worst.frame.name,
                                 worst.score.what_went_wrong));
  }
}

Document make_document(const Evaluation& evaluation) {
  Document document("vesalius: evaluation");
  document.paragraph(fmt::format("Model {} (checksum {}), vesalius {}.", evaluation.model, evaluation.model_checksum,
                                 VESALIUS_VERSION));
  document.preformatted(evaluation.command);
  document.paragraph(machine_facts() + ".");
  document.paragraph(
      "What each figure means: docs/metrics.md. Intervals are of 95 %: Wilson's for counts, the bootstrap over frames "
      "for all else.");
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
  const auto has_ablation = [](const SetResult& set) { return !set.ablation.empty(); };
  if (std::ranges::any_of(evaluation.sets, has_ablation)) {
    write_file_atomically((path / "ablation.csv").string(), ablation_csv(evaluation.sets));
  }
  write_file_atomically((path / "report.json").string(), evaluation_json(evaluation));
}

}  // namespace vesalius::cli
