#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "commands/train/grow_display.h"
#include "commands/train/train_inputs.h"
#include "report/document.h"
#include "train/grow_forest.h"
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

/// Size of the smaller sets that train_curves() holds beside the main one, as a share of its frames.
inline constexpr double kCurveFrames = 0.25;

/// Trains forests of two trees without hard negatives: on 1/16, 1/4 and all frames, and with 1/4, 1 and 4 times the
/// candidates. All are measured on the held-out samples of `set`, from whose frames none of them learns. `set` holds
/// all frames of `inputs` after `backgrounds` frames. Throws Error when the user interrupts.
std::vector<CurvePoint> train_curves(const TrainInputs& inputs, const TrainingSet& set, std::size_t backgrounds,
                                     const TrainOptions& options, bool shown);

}  // namespace vesalius::cli
