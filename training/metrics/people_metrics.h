#pragma once

#include <optional>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/match_people.h"
#include "metrics/metric_table.h"
#include "vesalius/body_model.h"
#include "vesalius/detect.h"

namespace vesalius {

/// The numbers of visible parts of a true person, and of those among them that a skeleton has in the right place.
struct PartCounts {
  int visible = 0;
  int right = 0;
  int visible_upper = 0;  ///< those of them that are parts of the upper body
  int right_upper = 0;
};

/// Smallest visible area of a part that counts as visible, cm^2.
inline constexpr double kVisiblePart_cm2 = 20.0;
/// Largest distance in metres of a part's found centre from the mean of its true pixels: the paper's tolerance of every
/// link.
inline constexpr double kPartTolerance_m = 0.15;

/// Returns for each part of a true person the mean of its pixels' points; NaN where it is not visible. The frame must
/// have labels.
std::vector<Eigen::Vector3f> visible_parts(const TrueFrame& frame, int person, const BodyModel& body);

/// Counts a skeleton's parts against the visible ones. Without truth of parts (`visible` is empty) every part counts as
/// visible and an observed one as right.
PartCounts count_parts(const Skeleton& skeleton, const std::vector<Eigen::Vector3f>& visible, const BodyModel& body);

/// Returns how often each visible part of somebody who is found is right, if the skeleton has at least four parts, and
/// if it has eight (the paper's Figs 11 and 10).
MetricTerms found_part_terms(const Skeleton& skeleton, const std::vector<Eigen::Vector3f>& visible,
                             const BodyModel& body);

/// Returns how many of the visible parts of the expected people are right, of all parts and of the upper body. A person
/// who was missed (null) has none right. Frames without labels have no such terms.
MetricTerms visible_part_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                               const BodyModel& body);

/// Returns the terms of a frame for people found and false people, for somebody in an empty frame, for its posture, for
/// the IoU of masks, and for how often each part was observed on the true people.
MetricTerms people_terms(const TrueFrame& frame, const std::vector<Person>& people, const std::vector<Match>& matches,
                         const BodyModel& body);

/// Returns by how many degrees the camera is turned about its viewing direction, 0 (upright) to 180; nothing if the
/// truth lacks the upward direction or the camera looks within 20 degrees of straight up or down.
std::optional<double> camera_roll_deg(const FrameTruth& truth);

/// Returns whether each true person was found, by each of these that is known: distance, the side turned to the camera
/// (heading_of), the visible share of the body's parts, the person's own posture, stature, and the camera's roll.
/// `of_person` has the found person for each true one, or null if the person was missed.
MetricTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person, const BodyModel& body);

/// A proposal of one frame and whether it is right.
struct JudgedProposal {
  float score = 0.F;
  int parts = 0;  ///< number of observed parts
  bool person = false;
  PartCounts counts;  ///< compared with the person that it shows
};

/// The data of curves: every proposal of a set of frames.
struct DetectionLog {
  long frames = 0;
  long expected = 0;  ///< true people
  std::vector<JudgedProposal> proposals;
};

/// The figures at one threshold. Shares of nothing are NaN.
struct DetectionPoint {
  double threshold = 0.0;
  double rate = 0.0;             ///< share of the true people found
  double false_per_frame = 0.0;  ///< number of false people
  double part_rate = 0.0;        ///< share of the visible parts of found people that are right
  double upper_part_rate = 0.0;  ///< the same for parts of the upper body
};

/// Returns a point for each minimum number of parts, 1 to `max_parts`, over the proposals whose score is at least
/// `min_score` (the paper's Figs 9 to 14).
std::vector<DetectionPoint> sweep_parts(const DetectionLog& log, int max_parts, double min_score);

/// Returns a point for each minimum score 0, 1/steps, ... 1, over the proposals that have at least `min_parts` parts.
std::vector<DetectionPoint> sweep_score(const DetectionLog& log, int steps, int min_parts);

}  // namespace vesalius
