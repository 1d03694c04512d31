#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metrics/fit_samples.h"
#include "metrics/frame_truth.h"
#include "metrics/joint_metrics.h"
#include "metrics/metric_table.h"
#include "metrics/people_metrics.h"
#include "metrics/pixel_metrics.h"
#include "vesalius/detect.h"
#include "vesalius/trace.h"

namespace vesalius {

/// Everything that one frame adds to the metrics of its set, and the pictures that explain it.
struct FrameScore {
  MetricTerms terms;
  int expected = 0;  ///< true people
  std::vector<JudgedProposal> proposals;
  JointPrecision joint_precision;           ///< over all proposed people, whatever their score
  JointPrecision centre_precision;          ///< the same of the parts' centres
  std::optional<PixelConfusion> confusion;  ///< empty if the true labels are not known
  std::vector<KnownPerson> known_people;    ///< only of frames for fitting joints

  std::string what_went_wrong;  ///< empty if nothing did
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
  };

  /// Throws the errors of Detector, and UsageError if the body has no such joint set.
  FrameScorer(Model model, Options options);

  /// Judges one frame. With `fit_joints` the score has the people found with their truth instead of joint metrics.
  /// Throws Error if truth and frame do not fit together.
  FrameScore score(TrueFrame frame, bool fit_joints) const;

  /// Judges the people that something else found in a frame, such as a tracker, by the same metrics but those of the
  /// labels and of proposals. Each needs a mask of the frame's size; Joint::behind counts them by falling score.
  /// `unseen` has for each true person, in the order of put_visible_people_first, somebody who is known to be there
  /// without being seen, or null: if it is not empty, the joints of all true people are judged. Throws Error if truth
  /// and frame do not fit together.
  FrameScore score_found(TrueFrame frame, std::vector<Person> people,
                         const std::vector<const Person*>& unseen = {}) const;

  /// Throws Error if truth and frame do not fit together.
  void check(const TrueFrame& frame) const;

  const BodyModel& body() const { return detector_.body(); }
  const Options& options() const { return options_; }

 private:
  /// Returns the labels that the detector gave; `asked`: Trace::person.
  FrameLabels find_people(const TrueFrame& frame, const Mask* asked, bool fit_joints, FrameScore& score) const;
  void log_proposals(const TrueFrame& frame, const Trace& trace, bool fit_joints, FrameScore& score) const;
  /// Judges score.people and returns the found person for each of the expected ones, or null.
  std::vector<const Person*> judge_people(const TrueFrame& frame, FrameScore& score) const;
  /// Returns the centres of the parts, for which a set must have a joint under each part's name.
  std::optional<KnownPoints> known_centres(const FrameTruth& truth) const;
  std::vector<Eigen::Vector3f> points_of(const Skeleton& skeleton, const KnownPoints& known) const;
  void judge_proposed_points(const KnownPoints& known, const std::vector<Proposal>& proposals, int expected,
                             JointPrecision& precision) const;
  void judge_points(const TrueFrame& frame, const std::vector<const Person*>& of_person, FrameScore& score) const;
  void keep_known_people(const TrueFrame& frame, const std::vector<const Person*>& of_person, FrameScore& score) const;
  void judge_labels(const TrueFrame& frame, const FrameLabels& labels, FrameScore& score) const;

  Options options_;
  Detector detector_;
};

}  // namespace vesalius
