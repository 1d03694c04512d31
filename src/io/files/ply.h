#pragma once

#include <cstdint>
#include <string>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"

namespace vesalius {

/// The pixels of `frame` that have depth as a binary little-endian PLY: x y z (float, metres, optical frame), red green
/// blue, label (part, 255 = none), person (index, 255 = none). Labelled points have their part's colour, others the
/// frame's own, or grey. `labels` and `person` have the depth's size.
std::string serialise_cloud(const Frame& frame, const LabelImage& labels, const Image<std::uint8_t>& person,
                            const BodyModel& body);

/// Writes it atomically. Both throw Error for pictures of different sizes and labels that `body` does not have; this
/// one also, with the path, when the file cannot be written.
void write_cloud(const Frame& frame, const LabelImage& labels, const Image<std::uint8_t>& person, const BodyModel& body,
                 const std::string& path);

}  // namespace vesalius
