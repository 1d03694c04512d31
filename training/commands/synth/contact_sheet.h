#pragma once

#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// Draws labelled frames side by side, `columns` in a row. Each frame shows its depth, colour (if it has any) and
/// labels under its name. Tiles are `tile_width` pixels wide. Throws Error if labels and depth differ in size.
ColourImage contact_sheet(const std::vector<LabelledFrame>& frames, const BodyModel& body, int columns,
                          int tile_width = 240);

}  // namespace vesalius
