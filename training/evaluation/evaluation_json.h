#pragma once

#include <string>
#include <vector>

#include "evaluation/evaluate_set.h"
#include "metrics/metric_table.h"

namespace vesalius {

/// Version of report.json that is written, and the only one that is read.
inline constexpr int kEvaluationVersion = 1;

/// Returns report.json (docs/metrics.md), which has all results as numbers, and null for unknown ones.
std::string evaluation_json(const Evaluation& evaluation);

/// Returns figures.csv: one line for each metric of each set, under a header. Commas in the sets' names become
/// semicolons.
std::string evaluation_csv(const Evaluation& evaluation);

/// A set of a report.json.
struct StoredSet {
  std::string name;
  std::string frames_key;  ///< two sets with the same key saw the same frames
  std::vector<Estimate> metrics;
};

/// Reads the sets of a report.json. Throws Error with the path if the file is not a report, is damaged, has another
/// version, or has a metric that is not in kMetrics.
std::vector<StoredSet> read_evaluation(const std::string& path);

/// A set of the first evaluation beside the one of the same name in the second.
struct SetComparison {
  std::string name;
  bool in_both = false;
  bool paired = false;  ///< both saw the same frames
  std::vector<Comparison> metrics{};
};

/// Compares two evaluations set by set, in the order of the first one's sets.
std::vector<SetComparison> compare_evaluations(const std::vector<StoredSet>& first,
                                               const std::vector<StoredSet>& second);

}  // namespace vesalius
