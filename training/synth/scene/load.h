#pragma once

#include <optional>

#include "synth/furniture/furniture.h"
#include "synth/scene/occupancy.h"

namespace vesalius::synth {

/// Returns what somebody who stands with both hands before them carries or pushes, in the body's frame: a box or a tray
/// on hands and forearms, a box between the hands, or a trolley or walker with its handles at the hands. Returns
/// nothing if the hands are elsewhere or no thing fits between them and the rest of the body.
std::optional<Furniture> make_load(const PosedBody& body, const BodyOutline& outline, Random& random);

}  // namespace vesalius::synth
