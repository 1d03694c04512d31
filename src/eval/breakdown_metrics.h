#pragma once

#include <vector>

#include "eval/metric_table.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Returns whether each true person was found, by distance, by the side turned to the camera (front: within 60 degrees,
/// back: beyond 120) and by the share of the body's parts that can be seen. `of_person` has the found person of each
/// true one, null where it was missed. Only frames of datasets have such terms: their joints are the centres of parts.
/// The heading follows from the parts called l_... and their partners; people whose left and right lie above each
/// other, as lying on a side, have none.
MetricTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person, const BodyModel& body);

}  // namespace vesalius
