#pragma once

#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/detect.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// Draws depth from near (warm) to far (cold) with black holes, in the size of `depth`. The colours span the frame's
/// 1st to 99th percentile; readings outside get the colour of the nearest end.
ColourImage draw_depth(const DepthImage& depth);

/// Draws part colours over a darkened depth picture. If `legend` is true, the parts' names stand at the right. Pictures
/// narrower than 480 pixels are doubled in size to keep the legend legible. Throws Error if `labels` and `depth` differ
/// in size or `body` lacks a label.
ColourImage draw_labels(const LabelImage& labels, const DepthImage& depth, const BodyModel& body, bool legend);

/// Draws people over the frame's colour, or over its depth if it has no colour. Each person has a tinted mask with an
/// outline, a skeleton and "number: score", which keeps its colour: of `numbers`, such as the ids of people who are
/// followed, or without these of their places in `people`. Observed parts are discs in their colours, predicted ones
/// rings; links between observed parts are thick, others thin. People whose masks are empty, such as hidden ones who
/// are followed, are left out and keep their number. Pictures narrower than 480 pixels are doubled in size. Throws
/// Error if a mask or skeleton does not fit the frame or the body, or `numbers` are not as many as people.
ColourImage draw_people(const Frame& frame, const std::vector<Person>& people, const BodyModel& body,
                        const std::vector<int>& numbers = {});

}  // namespace vesalius
