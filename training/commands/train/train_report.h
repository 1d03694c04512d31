#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "commands/train/grow_display.h"
#include "report/document.h"
#include "train/samples/sample_accuracy.h"

namespace vesalius::cli {

/// A forest that was trained for a curve, and its accuracy on the main set's held-out samples.
struct CurvePoint {
  double frame_share = 1.0;  ///< share of the frames learned from
  std::int64_t frames = 0;
  int candidates = 0;
  int trees = 0;
  AccuracyPoint accuracy;
  double seconds = 0.0;  ///< time to grow the forest
};

/// The figures of a training for its report.
struct TrainFigures {
  std::string model;  ///< path of the model
  std::uint64_t model_bytes = 0;
  GrowTotals grown;
  double reading_s = 0.0;
  int threads = 0;
  SampleAccuracy accuracy;
  std::vector<AccuracyPoint> by_trees, by_level;
  std::vector<CurvePoint> curves;  ///< may be empty
};

/// Returns a report with tables and plots: accuracy on held-out samples against trees and levels, the confusion matrix,
/// sizes, samples of each class and the recipe.
Document train_report(const Forest& forest, const TrainingSet& set, const TrainFigures& figures);

}  // namespace vesalius::cli
