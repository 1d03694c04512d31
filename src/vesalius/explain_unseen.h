#pragma once

#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns the picture without the columns and rows at its borders that have no reading, as sensors and undone lenses
/// leave them: a tenth of the picture on each side at most.
Box picture_with_readings(const DepthImage& depth);

/// Says of every joint and part of a frame's people why it is not observed (Unseen). The picture is looked at about the
/// place where it would be: beyond the picture, without readings, behind the pixels of a person or of something else,
/// or to be seen, most of the places there decide. People without a mask hide nobody; other masks have the frame's
/// size. Joints and parts of unknown place are looked for where the others make them most likely, those of bodies
/// without a distribution (predict_parts) nowhere.
void explain_unseen(const Frame& frame, const BodyModel& body, std::vector<Person>& people);
/// The same of people over frames, and of their smoothed joints.
void explain_unseen(const Frame& frame, const BodyModel& body, TrackedFrame& tracked);

}  // namespace vesalius
