#pragma once

#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/detect.h"

namespace vesalius {

/// Draws depth from near (warm) to far (cold), with black holes, in a picture of the size of `depth`. Colours span the
/// frame's 1st to 99th percentile; readings beyond take the colour of the nearer end.
ColourImage draw_depth(const DepthImage& depth);

/// Draws part colours over a darkened depth picture, with a legend of the parts' names at the right when `legend`.
/// Pictures narrower than 480 pixels come out twice as large, so that the legend stays legible.
/// Throws Error where `labels` has another size than `depth` or holds a label that the body lacks.
ColourImage draw_labels(const LabelImage& labels, const DepthImage& depth, const BodyModel& body, bool legend);

/// Draws people over the frame's colour (its depth where it has none): for each a tinted mask and outline, the skeleton
/// and "index: score". Observed parts are discs in their colours, predicted ones rings; links between observed parts
/// are thick, others thin. Pictures narrower than 480 pixels come out twice as large. Throws Error where a mask or
/// skeleton does not fit the frame or the body.
ColourImage draw_people(const Frame& frame, const std::vector<Person>& people, const BodyModel& body);

}  // namespace vesalius
