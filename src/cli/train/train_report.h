#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/train/grow_display.h"
#include "report/document.h"
#include "train/sample_accuracy.h"

namespace vesalius::cli {

/// A forest trained for a curve, and how good it is on the main set's held-out samples.
struct CurvePoint {
  double frame_share = 1.0;  ///< of the frames learned from
  std::int64_t frames = 0;
  int candidates = 0;
  int trees = 0;
  AccuracyPoint accuracy;
  double seconds = 0.0;  ///< growing it
};

/// What a report tells of a training.
struct TrainFigures {
  std::string model;  ///< its path
  std::uint64_t model_bytes = 0;
  GrowTotals grown;
  double reading_s = 0.0;
  int threads = 0;
  SampleAccuracy accuracy;
  std::vector<AccuracyPoint> by_trees, by_level;
  std::vector<CurvePoint> curves;  ///< may be empty
};

/// Tables and plots on how a forest came out: accuracy on held-out samples against trees and levels, the confusion
/// matrix, sizes, samples of each class, the recipe. Throws Error where gnuplot cannot be run.
Document train_report(const Forest& forest, const TrainingSet& set, const TrainFigures& figures);

/// Rows are true classes, columns given ones, each cell as dark as its share of the row; SVG with the classes' names.
std::string confusion_svg(const Confusion& confusion, const std::vector<std::string>& names);

/// Throws Error where gnuplot cannot be run: better known before the training than after it.
void expect_plots();

/// Writes `folder`/report.html, `folder`/report.md and the pictures that it links, each file whole. Throws Error naming
/// what cannot be written.
void write_report(const Document& document, const std::string& folder);

}  // namespace vesalius::cli
