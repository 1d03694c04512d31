#include "pictures.h"

#include <cmath>
#include <limits>
#include <string>

#include "vesalius/draw.h"
#include "vesalius/error.h"

namespace nb = nanobind;

namespace vesalius {
namespace {

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

void expect_size(const char* what, const DepthImage& depth, const Camera& camera) {
  if (depth.width() == camera.width && depth.height() == camera.height) return;
  throw UsageError(std::string(what) + ": a picture of " + size_text(depth.width(), depth.height()) + ", expected " +
                   size_text(camera.width, camera.height) + " as the people's frame");
}

}  // namespace

Doubles project(const Camera& camera, const Places& points) {
  if (points.ndim() == 0 || points.shape(points.ndim() - 1) != 3) {
    throw UsageError("project: expected an array of points (..., 3)");
  }
  std::vector<std::size_t> shape;
  for (std::size_t i = 0; i < points.ndim(); ++i) shape.push_back(points.shape(i));
  shape.back() = 2;
  std::vector<double> pixels;
  pixels.reserve(points.size() / 3 * 2);
  for (const double* p = points.data(); p != points.data() + points.size(); p += 3) {
    const bool is_known = !std::isnan(p[0]) && !std::isnan(p[1]) && p[2] > 0.0;
    const double away = is_known ? p[2] : std::numeric_limits<double>::quiet_NaN();
    pixels.push_back(p[0] / away * double(camera.fx) + double(camera.cx));
    pixels.push_back(p[1] / away * double(camera.fy) + double(camera.cy));
  }
  return array_of(std::move(pixels), std::move(shape));
}

nb::ndarray<nb::numpy, float> points_of(const Camera& camera, const DepthImage& depth, const Mask& mask) {
  expect_size("points", depth, camera);
  std::vector<float> values;
  for (int v = 0; v < mask.height(); ++v) {
    for (int u = 0; u < mask.width(); ++u) {
      if (mask(u, v) == 0 || depth(u, v) == 0) continue;
      const Eigen::Vector3f point = point_at(camera, depth, u, v);
      values.insert(values.end(), point.begin(), point.end());
    }
  }
  const std::size_t count = values.size() / 3;
  return array_of(std::move(values), {count, 3});
}

ColourImage drawn(const FoundPeople& people, const Frame& frame) {
  expect_size("draw", frame.depth, people.frame.camera);
  std::vector<int> ids;
  for (const TrackedPerson& person : people.people.people) {
    if (people.people.followed) ids.push_back(person.id);
  }
  return draw_people(frame, people_of(people.people), *people.body, ids);
}

ColourImage drawn(const FoundPeople& people, const AnyArray& picture) {
  Frame frame = people.frame;
  if (picture.ndim() == 2) {
    frame.depth = depth_image_of(picture);
  } else {
    frame.depth = DepthImage(frame.camera.width, frame.camera.height);
    frame.colour = colour_image_of(picture, frame.camera.width, frame.camera.height);
  }
  return drawn(people, frame);
}

}  // namespace vesalius
