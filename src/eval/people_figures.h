#pragma once

#include <vector>

#include "eval/figure_table.h"
#include "eval/match_people.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Which parts of a true person can be seen, and which of these a skeleton has in the right place.
struct PartCounts {
  int visible = 0;
  int right = 0;
  int visible_upper = 0;  ///< of the body's upper parts
  int right_upper = 0;
};

/// Smallest visible area of a part that counts as visible, cm^2, and how far its found centre may lie from the mean of
/// its true pixels, metres: the tolerance that the paper gives every link.
inline constexpr double kVisiblePart_cm2 = 20.0;
inline constexpr double kPartTolerance_m = 0.15;

/// Of each part of one true person (a frame with labels), the mean of its pixels' points; NaN where it is not visible.
std::vector<Eigen::Vector3f> visible_parts(const TrueFrame& frame, int person, const BodyModel& body);

/// Counts of a skeleton against the visible parts. Without part truth (`visible` empty) every part counts as visible
/// and an observed one as right: what the paper counts by eye then has to be taken on trust.
PartCounts count_parts(const Skeleton& skeleton, const std::vector<Eigen::Vector3f>& visible, const BodyModel& body);

/// Of the visible parts of the expected people of a frame with labels, those that are right (`parts.right`, and of the
/// upper body `parts.right_upper`); a person who was missed (null) has none. No terms without labels.
FigureTerms visible_part_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                               const BodyModel& body);

/// People found, false people, empty frames with somebody in them, rates of the frame's posture and of its camera's
/// motion, mask IoU, and how often each part was observed on the true people.
FigureTerms people_terms(const TrueFrame& frame, const std::vector<Person>& people, const std::vector<Match>& matches,
                         const BodyModel& body);

}  // namespace vesalius
