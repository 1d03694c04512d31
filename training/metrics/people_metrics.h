#pragma once

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
  int visible_upper = 0;  ///< of these, parts of the upper body
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

/// Returns how many of the visible parts of the expected people are right, of all parts and of the upper body. A person
/// who was missed (null) has none right. Frames without labels have no such terms.
MetricTerms visible_part_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                               const BodyModel& body);

/// Returns the terms of a frame for people found and false people, for somebody in an empty frame, for its posture, for
/// the IoU of masks, and for how often each part was observed on the true people.
MetricTerms people_terms(const TrueFrame& frame, const std::vector<Person>& people, const std::vector<Match>& matches,
                         const BodyModel& body);

}  // namespace vesalius
