#pragma once

#include <string>
#include <vector>

#include "evaluation/evaluation.h"
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

}  // namespace vesalius
