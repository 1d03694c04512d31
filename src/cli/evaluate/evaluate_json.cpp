#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/evaluate/evaluate_ablation.h"
#include "cli/evaluate/evaluate_report.h"
#include "cli/evaluate_machine.h"
#include "cli/json_number.h"
#include "io/files/options_file.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

using Json = nlohmann::ordered_json;

Json figure_json(const Estimate& estimate) {
  Json replicates = Json::array();
  for (const double value : estimate.replicates) {
    // Five digits are plenty for the spread of a mean and keep the file small.
    replicates.push_back(json_number(std::round(value * 1e5) / 1e5));
  }
  return {{"value", json_number(estimate.value)},
          {"low", json_number(estimate.interval.low)},
          {"high", json_number(estimate.interval.high)},
          {"numerator", estimate.numerator},
          {"denominator", estimate.denominator},
          {"better", kind_of(estimate.name).higher_is_better ? "higher" : "lower"},
          {"replicates", std::move(replicates)}};
}

Json curve_json(const std::vector<DetectionPoint>& curve) {
  Json points = Json::array();
  for (const DetectionPoint& point : curve) {
    points.push_back({{"threshold", point.threshold},
                      {"rate", json_number(point.rate)},
                      {"false_per_frame", json_number(point.false_per_frame)},
                      {"part_rate", json_number(point.part_rate)},
                      {"upper_part_rate", json_number(point.upper_part_rate)}});
  }
  return points;
}

Json joint_curve_json(const JointCurve& curve) {
  Json shares = Json::array();
  for (int cm = 1; cm <= kJointCurve_cm; ++cm) shares.push_back(json_number(curve.share(cm)));
  return shares;
}

Json confusion_json(const PixelConfusion& confusion) {
  Json rows = Json::array();
  for (int truth = 0; truth <= confusion.parts(); ++truth) {
    Json row = Json::array();
    for (int given = 0; given <= confusion.parts(); ++given) row.push_back(confusion.count(truth, given));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json set_json(const SetResult& set, const Evaluation& evaluation) {
  Json figures = Json::object();
  for (const Estimate& estimate : set.figures.estimates()) figures[estimate.name] = figure_json(estimate);
  Json json = {{"name", set.name},
               {"source", set.source},
               {"frames", set.frames},
               {"failed", set.failed},
               {"failures", set.failures},
               {"notes", set.notes},
               {"frames_key", fmt::format("{:016x}", set.figures.frames_key())},
               {"seconds", set.seconds},
               {"figures", std::move(figures)}};
  if (!evaluation.labels_only) {
    const RefineOptions& refine = evaluation.options.refine;
    json["curve_over_parts"] =
        curve_json(sweep_parts(set.log, evaluation.body.part_count(), static_cast<double>(refine.min_score)));
    json["curve_over_score"] = curve_json(sweep_score(set.log, kScoreSteps, refine.min_parts));
  }
  if (set.joint_curve.joints > 0) json["joints_within_cm"] = joint_curve_json(set.joint_curve);
  for (const auto& [joint, precision] : set.joint_precision.averages()) json["joint_precision"][joint] = precision;
  if (!set.ablation.empty()) json["ablation"] = ablation_json(set);
  if (set.confusion) json["confusion"] = confusion_json(*set.confusion);
  Json worst = Json::array();
  for (const WorstFrame& frame : set.worst) {
    worst.push_back({{"frame", frame.frame.name}, {"wrong", frame.score.what_went_wrong}});
  }
  json["worst"] = std::move(worst);
  return json;
}

}  // namespace

std::string evaluation_json(const Evaluation& evaluation) {
  DetectOptions options = evaluation.options;
  Json parts = Json::array();
  for (const BodyPart& part : evaluation.body.parts) parts.push_back(part.name);
  Json sets = Json::array();
  for (const SetResult& set : evaluation.sets) sets.push_back(set_json(set, evaluation));
  const Json json = {
      {"vesalius_evaluation", kEvaluationVersion},
      {"command", evaluation.command},
      {"version", VESALIUS_VERSION},
      {"model", {{"path", evaluation.model}, {"checksum", evaluation.model_checksum}, {"parts", std::move(parts)}}},
      {"options", options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); })},
      {"machine", machine_facts()},
      {"labels_only", evaluation.labels_only},
      {"sets", std::move(sets)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string evaluation_csv(const Evaluation& evaluation) {
  std::string csv = "set,figure,value,low,high,numerator,denominator,better\n";
  for (const SetResult& set : evaluation.sets) {
    const std::string name = csv_field(set.name);
    for (const Estimate& e : set.figures.estimates()) {
      csv += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.10g},{:.10g},{}\n", name, e.name, e.value, e.interval.low,
                         e.interval.high, e.numerator, e.denominator,
                         kind_of(e.name).higher_is_better ? "higher" : "lower");
    }
  }
  return csv;
}

}  // namespace vesalius::cli
