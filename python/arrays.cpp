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

/// Returns the name that numpy has for the type of an array's values.
std::string dtype_of(const AnyArray& array) {
  const nb::dlpack::dtype type = array.dtype();
  const auto code = static_cast<nb::dlpack::dtype_code>(type.code);
  const std::string bits = std::to_string(int(type.bits));
  if (code == nb::dlpack::dtype_code::Int) return "int" + bits;
  if (code == nb::dlpack::dtype_code::UInt) return "uint" + bits;
  if (code == nb::dlpack::dtype_code::Float) return "float" + bits;
  return code == nb::dlpack::dtype_code::Bool ? "bool" : "another";
}

}  // namespace

DepthImage depth_image_of(const AnyArray& array) {
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
    throw UsageError("depth: an array of dtype " + dtype_of(array) +
                     ", expected dtype uint16 (millimetres) or float32 (metres)");
  }
  return depth;
}

ColourImage colour_image_of(const AnyArray& array, int width, int height) {
  const bool fits = array.ndim() == 3 && static_cast<int>(array.shape(0)) == height &&
                    static_cast<int>(array.shape(1)) == width && array.shape(2) == 3;
  if (!fits || array.dtype() != nb::dtype<std::uint8_t>()) {
    throw UsageError("colour: an array of shape " + shape_of(array) + " and dtype " + dtype_of(array) + ", expected " +
                     std::to_string(height) + "x" + std::to_string(width) + "x3 of dtype uint8 (red, green, blue)");
  }
  ColourImage colour(width, height);
  static_assert(sizeof(Rgb) == 3);
  std::memcpy(colour.data(), array.data(), colour.size() * sizeof(Rgb));
  return colour;
}

Frame frame_of(const AnyArray& depth, const PythonCamera& camera, const std::optional<AnyArray>& colour,
               std::optional<double> time_s) {
  Frame frame;
  frame.depth = depth_image_of(depth);
  if (colour) frame.colour = colour_image_of(*colour, frame.depth.width(), frame.depth.height());
  frame.camera = camera.of(frame.depth.width(), frame.depth.height());
  frame.time_s = time_s;
  if (time_s && !std::isfinite(*time_s)) throw UsageError("time: expected a number of seconds");
  return frame;
}

}  // namespace vesalius
