#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "eval/detection_curve.h"
#include "eval/fit_score.h"
#include "eval/joint_metrics.h"
#include "eval/joint_precision.h"
#include "eval/metric_table.h"
#include "eval/pixel_metrics.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Everything that one frame adds to the metrics of its set, and what shows why.
struct FrameScore {
  MetricTerms terms;
  int expected = 0;  ///< true people
  std::vector<JudgedProposal> proposals;
  std::vector<ScoreSample> samples;                 ///< to fit the score on
  std::vector<std::vector<double>> joint_errors_m;  ///< of each true person (joint_errors)
  JointPrecision joint_precision;                   ///< of all people proposed, whatever their score
  std::optional<PixelConfusion> confusion;          ///< where the true labels are known
  std::vector<JointOffset> offsets;                 ///< of a frame to fit joints on

  std::string what_went_wrong;  ///< empty where nothing did
  double detect_s = 0.0;        ///< time that the detector took; 0 where only labels were asked for
  double badness = 0.0;         ///< 0 = all is right; ranks the frames worth looking at
  std::vector<Person> people;
  LabelImage labels;  ///< first pass, smoothed
};

/// Runs the detector over frames whose truth is known and judges what it finds. Safe to call from several threads.
class FrameScorer {
 public:
  struct Options {
    DetectOptions detect;
    bool labels_only = false;  ///< only the pixel metrics of the first pass: much faster
  };

  /// Throws as Detector does.
  FrameScorer(std::shared_ptr<const PixelLabeller> labeller, Options options);

  /// Judges one frame. With `fit_joints` the score has joint offsets instead of joint metrics, from the true labels
  /// where these are known, else from the people found. Throws Error where truth and frame do not fit together.
  FrameScore score(TrueFrame frame, bool fit_joints) const;

  const BodyModel& body() const { return detector_.body(); }
  const Options& options() const { return options_; }

 private:
  /// Returns the labels that the detector gave; `asked`: Trace::person.
  FrameLabels find_people(const TrueFrame& frame, const Mask* asked, bool fit_joints, FrameScore& score) const;
  void log_proposals(const TrueFrame& frame, const Trace& trace, bool fit_joints, FrameScore& score) const;
  /// The body's joint set that has all of the truth's joints; null where there are none.
  const JointSet* joint_set_of(const FrameTruth& truth) const;
  void judge_joint_proposals(const TrueFrame& frame, const std::vector<Proposal>& proposals, FrameScore& score) const;
  void judge_joints(const TrueFrame& frame, const std::vector<const Person*>& of_person, bool fit,
                    FrameScore& score) const;
  void judge_labels(const TrueFrame& frame, const FrameLabels& labels, FrameScore& score) const;

  Options options_;
  Detector detector_;
};

}  // namespace vesalius
