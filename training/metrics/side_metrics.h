#pragma once

#include <optional>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/metric_table.h"
#include "vesalius/body_model.h"
#include "vesalius/detect.h"

namespace vesalius {

/// How many of the points that were given out for a person lie where.
struct GivenPoints {
  int all = 0;
  int right = 0;     ///< within the tolerance of their own truth
  int mirrored = 0;  ///< not right, and within the tolerance of their partner's truth
  int paired = 0;    ///< points whose truth is known on both sides
  int swapped = 0;   ///< paired ones that are nearer to their partner's truth than to their own
};

/// Counts the points of `found` (NaN = not given out) whose truth is known. All have the order of `names`, in metres.
GivenPoints count_given(const SidedNames& names, const std::vector<Eigen::Vector3f>& found,
                        const std::vector<Eigen::Vector3f>& truth, double tolerance_m);

/// The metrics that GivenPoints make, each with its family by heading.
enum class GivenKind { parts, joints };
/// Returns where a person's points lie, and, if `with_swapped` is true, whether most of the paired ones are swapped; of
/// joints that is said in any case, by a metric of its own.
MetricTerms given_terms(const GivenPoints& points, GivenKind kind, std::optional<Heading> heading, bool with_swapped);

/// Returns where the observed parts of the found people lie, within kPartTolerance_m, and whether left and right are
/// swapped. The truth of a part is the mean of its true pixels where it is visible (visible_parts), otherwise the
/// centre of its volume. Only people whose parts' centres are known have such terms.
MetricTerms given_part_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                             const BodyModel& body);

/// Returns how many of the found people's pairs of observed parts lie in the order of the heading: from the front the
/// left part at the picture's right of the right part, from the back at its left. Elbows, forearms and hands, which may
/// be crossed, are counted apart. People seen from the side or lying, and those whom a camera rolled by 45 degrees or
/// more sees, have no such terms. `of_person` may be people of whom nothing but the frame's heading is known.
MetricTerms side_order_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                             const BodyModel& body);

/// Returns whether the yaw of each found person lies within 45 degrees of that of the true parts' centres, by the true
/// heading and by the confidence that the yaw was given with.
MetricTerms yaw_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person, const BodyModel& body);

}  // namespace vesalius
