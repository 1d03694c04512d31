#pragma once

#include <vector>

#include "eval/metric_table.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Returns whether each true person was found, by distance, by the side turned to the camera (front: within 60 degrees,
/// back: beyond 120) and by the visible share of the body's parts. `of_person` has the found person for each true one,
/// or null if the person was missed. Only frames of datasets have such terms, because their joints are the centres of
/// parts. The heading follows from the parts called l_... and their partners; people whose left side is above their
/// right, as when lying on a side, have none.
MetricTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person, const BodyModel& body);

}  // namespace vesalius
