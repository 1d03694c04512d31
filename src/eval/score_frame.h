#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "eval/boost_trees.h"
#include "eval/detection_curve.h"
#include "eval/fit_joints.h"
#include "eval/fit_score.h"
#include "eval/joint_metrics.h"
#include "eval/joint_precision.h"
#include "eval/metric_table.h"
#include "eval/pixel_metrics.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Everything that one frame adds to the metrics of its set, and the pictures that explain it.
struct FrameScore {
  MetricTerms terms;
  int expected = 0;  ///< true people
  std::vector<JudgedProposal> proposals;
  std::vector<ScoreSample> samples;                 ///< for fitting the score
  std::vector<BoostSample> context_samples;         ///< for fitting the context of bodies, if asked for
  std::vector<std::vector<double>> joint_errors_m;  ///< joint_errors() of each true person
  JointPrecision joint_precision;                   ///< over all proposed people, whatever their score
  JointPrecision centre_precision;                  ///< the same of the parts' centres
  std::optional<PixelConfusion> confusion;          ///< empty if the true labels are not known
  std::vector<KnownPerson> known_people;            ///< only of frames for fitting joints

  std::string what_went_wrong;  ///< empty if nothing did
  double detect_s = 0.0;        ///< time of the detector; 0 if only labels were requested
  double badness = 0.0;         ///< 0 if everything is right; ranks the frames for reports
  std::vector<Person> people;
  LabelImage labels;  ///< smoothed labels of the first pass
};

/// Runs the detector on frames whose truth is known and judges the result. It may be used from several threads.
class FrameScorer {
 public:
  struct Options {
    DetectOptions detect;
    bool labels_only = false;  ///< only the pixel metrics of the first pass: much faster
    std::string joint_set{};   ///< joint set to compare joints with and to fit; empty means the truth's own choice
    bool fit_context = false;  ///< only keeps context_samples of labelled frames and measures nothing
  };

  /// Throws the errors of Detector, and UsageError if the body has no such joint set.
  FrameScorer(std::shared_ptr<const PixelLabeller> labeller, Options options);

  /// Judges one frame. With `fit_joints` the score has the people found with their truth instead of joint metrics.
  /// Throws Error if truth and frame do not fit together.
  FrameScore score(TrueFrame frame, bool fit_joints) const;

  const BodyModel& body() const { return detector_.body(); }
  const Options& options() const { return options_; }

 private:
  /// Returns the labels that the detector gave; `asked`: Trace::person.
  FrameLabels find_people(const TrueFrame& frame, const Mask* asked, bool fit_joints, FrameScore& score) const;
  void log_proposals(const TrueFrame& frame, const Trace& trace, bool fit_joints, FrameScore& score) const;
  /// Points of the true people that a joint set of the body predicts.
  struct KnownPoints {
    const JointSet* set = nullptr;
    std::vector<std::string> names;  ///< those that the set has
    std::vector<std::vector<Eigen::Vector3f>> of_person;
  };
  std::optional<KnownPoints> known_joints(const FrameTruth& truth) const;
  /// Returns the centres of the parts, for which a set must have a joint under each part's name.
  std::optional<KnownPoints> known_centres(const FrameTruth& truth) const;
  std::vector<Eigen::Vector3f> points_of(const Skeleton& skeleton, const KnownPoints& known) const;
  void judge_proposed_points(const KnownPoints& known, const std::vector<Proposal>& proposals, int expected,
                             JointPrecision& precision) const;
  void judge_points(const TrueFrame& frame, const std::vector<const Person*>& of_person, FrameScore& score) const;
  void keep_known_people(const TrueFrame& frame, const std::vector<const Person*>& of_person, FrameScore& score) const;
  void judge_labels(const TrueFrame& frame, const FrameLabels& labels, FrameScore& score) const;

  Options options_;
  std::shared_ptr<const PixelLabeller> labeller_;
  Detector detector_;
};

}  // namespace vesalius
