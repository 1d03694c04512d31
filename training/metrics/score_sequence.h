#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "metrics/motion_metrics.h"
#include "metrics/score_frame.h"
#include "metrics/track_metrics.h"
#include "vesalius/person.h"

namespace vesalius {

/// Follows the people of one sequence: is given its frames in their order and returns who is in each.
using SequenceTracker = std::function<TrackedFrame(const Frame&)>;
/// Makes a tracker for a new sequence. It may be called, and the trackers used, from several threads.
using SequenceTrackerFactory = std::function<SequenceTracker()>;

/// Judges the people who were followed over one sequence whose truth is known.
class SequenceScorer {
 public:
  struct Options {
    bool hidden = false;   ///< people without pixels take part, true and found ones (track_people_of)
    bool trust = false;    ///< keeps the joints of fitted bodies with their truth (trust_samples)
    bool stances = false;  ///< keeps the postures with the true stances (stance_samples)
  };

  /// `judge` must outlive it; its options name the joint set.
  SequenceScorer(const FrameScorer& judge, Options options) : judge_(judge), options_(options) {}

  /// Judges the next frame as score_found does: of each person the smoothed joints where there are some, otherwise
  /// those of the frame. Throws Error if truth, frame and people do not fit together, or its joints have other names
  /// than those before; the frame then does not count.
  FrameScore add(TrueFrame frame, TrackedFrame tracked);

  /// Returns what the sequence as a whole adds to the metrics, [frame]: tracks (track_terms) if the ids of all true
  /// people are known, motion (add_motion_terms) and stances besides if somebody's joints or stance are. Nothing may
  /// be added afterwards.
  std::vector<MetricTerms> finish();

  /// Gives away the fitted joints of all people who were matched, by frame and true person (Options::trust).
  std::vector<TrustSample> take_trust_samples() { return std::move(trust_samples_); }
  /// Gives away the postures of all people who were matched and whose true stance is known (Options::stances).
  std::vector<StanceSample> take_stance_samples() { return std::move(stance_samples_); }

 private:
  void check_names(const TrueFrame& frame);
  void follow(const TrueFrame& frame, const TrackPeople& people, const std::vector<int>& match, double time_s);
  void judge_stance(const FrameTruth& truth, std::size_t person, const TrackedPerson& found);

  const FrameScorer& judge_;
  Options options_;
  bool ids_known_ = true;
  std::vector<std::string> joint_names_;
  TrackMatcher matcher_;
  std::vector<TrackSample> samples_;        ///< [frame]
  std::vector<MetricTerms> terms_;          ///< [frame]
  std::map<int, PersonMotion> people_;      ///< by true id
  std::map<int, std::size_t> first_frame_;  ///< first frame of each found id
  std::vector<TrustSample> trust_samples_;
  std::vector<StanceSample> stance_samples_;
};

}  // namespace vesalius
