#pragma once

#include <optional>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/metric_table.h"
#include "vesalius/body_model.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Returns by how many degrees the camera is turned about its viewing direction, 0 (upright) to 180; nothing if the
/// truth lacks the upward direction or the camera looks within 20 degrees of straight up or down.
std::optional<double> camera_roll_deg(const FrameTruth& truth);

/// Returns whether each true person was found, by each of these that is known: distance, the side turned to the camera
/// (heading_of), the visible share of the body's parts, the person's own posture, stature, and the camera's roll.
/// `of_person` has the found person for each true one, or null if the person was missed.
MetricTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person, const BodyModel& body);

}  // namespace vesalius
