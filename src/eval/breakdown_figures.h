#pragma once

#include <vector>

#include "eval/figure_table.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"

namespace vesalius {

/// How far away a true person is, which side they turn to the camera and how many of their parts can be seen, each with
/// whether they were found (`of_person`: null = missed): `distance.A-Bm`, `heading.front` (within 60 degrees), `side`,
/// `back` (beyond 120), `visible.A-B%` of the body's parts. For frames of datasets, whose joints are the centres of
/// parts; no terms for others. Left are the parts called l_...; no heading for who has left and right above each other,
/// as lying on a side.
FigureTerms breakdown_terms(const TrueFrame& frame, const std::vector<const Person*>& of_person, const BodyModel& body);

}  // namespace vesalius
