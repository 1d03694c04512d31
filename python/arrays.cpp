#include "arrays.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "vesalius/base/depth_reading.h"
#include "vesalius/error.h"

namespace nb = nanobind;

namespace vesalius {
namespace {

std::string shape_of(const AnyArray& array) {
  std::string text;
  for (std::size_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? "x" : "") + std::to_string(array.shape(i));
  return text;
}

DepthImage depth_of(const AnyArray& array) {
  if (array.ndim() != 2) throw UsageError("depth: an array of shape " + shape_of(array) + ", expected height x width");
  constexpr std::size_t kMostSide = 16000;
  if (array.shape(0) > kMostSide || array.shape(1) > kMostSide) {
    throw UsageError("depth: an array of shape " + shape_of(array) + ", expected at most 16000 a side");
  }
  DepthImage depth(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  if (array.dtype() == nb::dtype<std::uint16_t>()) {
    std::memcpy(depth.data(), array.data(), depth.size() * sizeof(std::uint16_t));
  } else if (array.dtype() == nb::dtype<float>()) {
    const auto* metres = static_cast<const float*>(array.data());
    std::transform(metres, metres + depth.size(), depth.begin(), depth_reading);
  } else {
    throw UsageError("depth: expected dtype uint16 (millimetres) or float32 (metres)");
  }
  return depth;
}

ColourImage colour_of(const std::optional<AnyArray>& array, const DepthImage& depth) {
  if (!array) return {};
  const bool fits = array->ndim() == 3 && static_cast<int>(array->shape(0)) == depth.height() &&
                    static_cast<int>(array->shape(1)) == depth.width() && array->shape(2) == 3;
  if (!fits || array->dtype() != nb::dtype<std::uint8_t>()) {
    throw UsageError("colour: an array of shape " + shape_of(*array) + ", expected " + std::to_string(depth.height()) +
                     "x" + std::to_string(depth.width()) + "x3 of dtype uint8 (red, green, blue)");
  }
  ColourImage colour(depth.width(), depth.height());
  static_assert(sizeof(Rgb) == 3);
  std::memcpy(colour.data(), array->data(), colour.size() * sizeof(Rgb));
  return colour;
}

}  // namespace

Frame frame_of(const AnyArray& depth, const PythonCamera& camera, const std::optional<AnyArray>& colour,
               std::optional<double> time_s) {
  Frame frame;
  frame.depth = depth_of(depth);
  frame.colour = colour_of(colour, frame.depth);
  frame.camera = {frame.depth.width(), frame.depth.height(), camera.fx, camera.fy, camera.cx, camera.cy};
  frame.time_s = time_s;
  if (time_s && !std::isfinite(*time_s)) throw UsageError("time: expected a number of seconds");
  return frame;
}

}  // namespace vesalius
