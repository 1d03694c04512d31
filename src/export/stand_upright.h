#pragma once

#include "export/people_record.h"

namespace vesalius {

/// Puts joints and bones onto the floor: from each frame's optical frame into one that is level and has its origin on
/// the floor below the camera, with the axes named alike (x right, y down, z away). A frame without a floor takes that
/// of the nearest before it, or else the first that there is. Pixels, and rotations of joints, stay as they are.
/// Returns whether any frame knows a floor; if none does, nothing changes.
bool stand_upright(PeopleRecord& record);

}  // namespace vesalius
