#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// The camera of the depth picture, in pixels.
struct PythonCamera {
  float fx, fy, cx, cy;

  explicit PythonCamera(const Camera& camera) : fx(camera.fx), fy(camera.fy), cx(camera.cx), cy(camera.cy) {}
  PythonCamera(float focal_x, float focal_y, float centre_x, float centre_y)
      : fx(focal_x), fy(focal_y), cx(centre_x), cy(centre_y) {}
  /// For pictures of a size.
  Camera of(int width, int height) const { return {width, height, fx, fy, cx, cy}; }
};

using AnyArray = nanobind::ndarray<nanobind::ro, nanobind::c_contig, nanobind::device::cpu>;

/// Returns a copy of an array (height, width) of uint16 millimetres or float32 metres. Throws UsageError for another.
DepthImage depth_image_of(const AnyArray& array);

/// Returns a copy of an array (height, width, 3) of uint8, of this size. Throws UsageError for another.
ColourImage colour_image_of(const AnyArray& array, int width, int height);

/// Returns a frame with copies of the arrays: depth (height, width) uint16 millimetres or float32 metres, colour
/// (height, width, 3) uint8. Throws UsageError for another dtype or shape, and for a time that is no number.
Frame frame_of(const AnyArray& depth, const PythonCamera& camera, const std::optional<AnyArray>& colour,
               std::optional<double> time_s);

/// Returns the names of parts, joints and the like.
template <class Item>
std::vector<std::string> names_of(const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  return names;
}

/// Returns a numpy array that keeps its values alive.
template <class T>
nanobind::ndarray<nanobind::numpy, T> array_of(std::vector<T> values, std::vector<std::size_t> shape) {
  auto* kept = new std::vector<T>(std::move(values));
  const nanobind::capsule owner(kept, [](void* at) noexcept { delete static_cast<std::vector<T>*>(at); });
  return nanobind::ndarray<nanobind::numpy, T>(kept->data(), shape.size(), shape.data(), owner);
}

template <class T>
nanobind::ndarray<nanobind::numpy, T> array_of(const Image<T>& image) {
  return array_of(std::vector<T>(image.begin(), image.end()),
                  {static_cast<std::size_t>(image.height()), static_cast<std::size_t>(image.width())});
}

}  // namespace vesalius
