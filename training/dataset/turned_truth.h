#pragma once

#include <memory>

#include "dataset/truth_source.h"

namespace vesalius {

/// Returns the same frame as a camera sees it that is rolled about the axis through its principal point, clockwise in
/// the picture by so many degrees. Depth is along that axis, so readings stay as they are; each pixel takes the nearest
/// one. The picture grows to hold all of the old one, and what is new in it has no reading. Throws Error if fx and fy
/// differ by more than a twentieth.
TrueFrame turned(const TrueFrame& frame, double degrees);

/// Returns the frames of a source, turned.
std::unique_ptr<TruthSource> with_turn(std::unique_ptr<TruthSource> frames, double degrees);

}  // namespace vesalius
