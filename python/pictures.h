#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "arrays.h"
#include "frames.h"
#include "people.h"

namespace vesalius {

using Doubles = nanobind::ndarray<nanobind::numpy, double>;

/// Any array of numbers, as numbers of double precision.
using Places = nanobind::ndarray<const double, nanobind::c_contig, nanobind::device::cpu>;

/// Returns the pixels (..., 2) in which a camera sees points (..., 3): not-a-number where they are unknown or not in
/// front of it. Throws UsageError for another shape.
Doubles project(const Camera& camera, const Places& points);

/// Returns what depth tells of the pixels of a mask that have readings, row by row: float32 (points, 3), metres. Throws
/// UsageError where the sizes differ.
nanobind::ndarray<nanobind::numpy, float> points_of(const Camera& camera, const DepthImage& depth, const Mask& mask);

/// Returns people drawn over a frame's colour, or its depth without colour. Throws UsageError where its size is not
/// that of the frame in which they were found.
ColourImage drawn(const FoundPeople& people, const Frame& frame);

/// Returns people drawn over an array: colour (height, width, 3) uint8, or depth.
ColourImage drawn(const FoundPeople& people, const AnyArray& picture);

}  // namespace vesalius
