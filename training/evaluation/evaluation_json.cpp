#include "evaluation/evaluation_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/files/data_file.h"
#include "io/files/options_file.h"
#include "metrics/metric_table.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

/// Returns null for a value that is not finite, since JSON has no NaN.
Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json metric_json(const Estimate& estimate) {
  Json replicates = Json::array();
  for (const double value : estimate.replicates) {
    // Five digits suffice for the spread of a mean and keep the file small.
    replicates.push_back(json_number(std::round(value * 1e5) / 1e5));
  }
  return {{"value", json_number(estimate.value)},        {"low", json_number(estimate.interval.low)},
          {"high", json_number(estimate.interval.high)}, {"numerator", estimate.numerator},
          {"denominator", estimate.denominator},         {"better", better_word(estimate.id.metric)},
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
  Json metrics = Json::object();
  for (const Estimate& estimate : set.metrics.estimates()) metrics[estimate.id.name()] = metric_json(estimate);
  Json json = {{"name", set.name},
               {"source", set.source},
               {"frames", set.frames},
               {"failed", set.failed},
               {"failures", set.failures},
               {"notes", set.notes},
               {"frames_key", fmt::format("{:016x}", set.metrics.frames_key())},
               {"seconds", set.seconds},
               {"figures", std::move(metrics)}};
  if (!evaluation.labels_only && !evaluation.tracked) {
    const RefineOptions& refine = evaluation.options.detect.refine;
    json["curve_over_parts"] = curve_json(sweep_parts(set.log, evaluation.body.part_count(), double(refine.min_score)));
    json["curve_over_score"] = curve_json(sweep_score(set.log, kScoreSteps, refine.min_parts));
  }
  for (const auto& [joint, precision] : set.joint_precision.averages()) json["joint_precision"][joint] = precision;
  for (const auto& [part, precision] : set.centre_precision.averages()) json["centre_precision"][part] = precision;
  if (set.confusion) json["confusion"] = confusion_json(*set.confusion);
  Json worst = Json::array();
  for (const WorstFrame& frame : set.worst) {
    worst.push_back({{"frame", frame.frame.name}, {"wrong", frame.score.what_went_wrong}});
  }
  json["worst"] = std::move(worst);
  return json;
}

Estimate read_metric(const std::string& name, const Json& json) {
  const auto id = parse_metric(name);
  if (!id) throw Error(fmt::format("unknown metric {}", name));
  Estimate estimate{*id};
  estimate.value = number(json.at("value"));
  estimate.interval = {number(json.at("low")), number(json.at("high"))};
  estimate.numerator = json.at("numerator").get<double>();
  estimate.denominator = json.at("denominator").get<double>();
  const Json& replicates = json.at("replicates");
  if (replicates.size() != kReplicates) throw Error(fmt::format("{}: expected {} replicates", name, kReplicates));
  for (const Json& value : replicates) estimate.replicates.push_back(number(value));
  return estimate;
}

StoredSet read_set(const Json& json) {
  StoredSet set{json.at("name").get<std::string>(), json.at("frames_key").get<std::string>(), {}};
  for (const auto& [name, metric] : json.at("figures").items()) set.metrics.push_back(read_metric(name, metric));
  return set;
}

}  // namespace

std::string evaluation_json(const Evaluation& evaluation) {
  PeopleOptions options = evaluation.options;
  const auto visit = [&](OptionVisitor& visitor) {
    if (evaluation.tracked) return visit_options("", options, visitor);
    visit_options("", options.detect, visitor);
  };
  Json parts = Json::array();
  for (const BodyPart& part : evaluation.body.parts) parts.push_back(part.name);
  Json sets = Json::array();
  for (const SetResult& set : evaluation.sets) sets.push_back(set_json(set, evaluation));
  const Json json = {
      {"vesalius_evaluation", kEvaluationVersion},
      {"command", evaluation.command},
      {"version", evaluation.version},
      {"model", {{"path", evaluation.model}, {"checksum", evaluation.model_checksum}, {"parts", std::move(parts)}}},
      {"options", options_toml(visit)},
      {"machine", evaluation.machine},
      {"labels_only", evaluation.labels_only},
      {"tracked", evaluation.tracked},
      {"sets", std::move(sets)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

std::string evaluation_csv(const Evaluation& evaluation) {
  std::string csv = "set,figure,value,low,high,numerator,denominator,better\n";
  for (const SetResult& set : evaluation.sets) {
    std::string name = set.name;
    std::ranges::replace(name, ',', ';');
    for (const Estimate& e : set.metrics.estimates()) {
      csv += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.10g},{:.10g},{}\n", name, e.id.name(), e.value, e.interval.low,
                         e.interval.high, e.numerator, e.denominator, better_word(e.id.metric));
    }
  }
  return csv;
}

std::vector<StoredSet> read_evaluation(const std::string& path) {
  const Json json = Json::parse(read_file(path), nullptr, false);
  if (!json.is_object() || !json.contains("vesalius_evaluation")) {
    throw Error(path + ": no evaluation, expected the report.json of `vesalius evaluate`");
  }
  try {
    const int version = json.at("vesalius_evaluation").get<int>();
    if (version != kEvaluationVersion) {
      throw Error(fmt::format("version {}, expected {}", version, kEvaluationVersion));
    }
    std::vector<StoredSet> sets;
    for (const Json& set : json.at("sets")) sets.push_back(read_set(set));
    return sets;
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("{}: damaged evaluation: {}", path, e.what()));
  } catch (const Error& e) {
    throw Error(fmt::format("{}: {}", path, e.what()));
  }
}

std::vector<SetComparison> compare_evaluations(const std::vector<StoredSet>& first,
                                               const std::vector<StoredSet>& second) {
  std::vector<SetComparison> sets;
  for (const StoredSet& set : first) {
    SetComparison& comparison = sets.emplace_back(SetComparison{set.name});
    const auto other = std::ranges::find(second, set.name, &StoredSet::name);
    if (other == second.end()) continue;
    comparison.in_both = true;
    comparison.paired = set.frames_key == other->frames_key;
    comparison.metrics = compare_common(set.metrics, other->metrics, comparison.paired);
  }
  return sets;
}

}  // namespace vesalius
