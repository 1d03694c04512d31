#pragma once

#include <cstdint>
#include <string>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"

namespace vesalius {

/// Returns the pixels of `frame` that have depth as a binary little-endian PLY file. Each vertex has x y z (float,
/// metres, optical frame), red green blue, label (part, 255 = none) and person (index, 255 = none). Labelled points
/// have their part's colour; others have the frame's own colour, or grey. `labels` and `person` must have the depth's
/// size. Throws Error if the sizes differ or `body` lacks a label.
std::string serialise_cloud(const Frame& frame, const LabelImage& labels, const Image<std::uint8_t>& person,
                            const BodyModel& body);

/// Writes the file of `serialise_cloud` atomically. Throws the same errors, and Error with the path if the file cannot
/// be written.
void write_cloud(const Frame& frame, const LabelImage& labels, const Image<std::uint8_t>& person, const BodyModel& body,
                 const std::string& path);

}  // namespace vesalius
