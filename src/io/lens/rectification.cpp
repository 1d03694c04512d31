#include "io/lens/rectification.h"

#include <fmt/format.h>

#include "io/lens/fixed_point.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kRowsAtOnce = 16;

void expect_size(int width, int height, int picture_width, int picture_height) {
  if (picture_width == width && picture_height == height) return;
  throw Error(fmt::format("a picture of {}x{} pixels, expected {}x{} of the calibration", picture_width, picture_height,
                          width, height));
}

}  // namespace

Rectification::Rectification(const LensCamera& from, const Camera& to)
    : width_(from.camera.width), height_(from.camera.height), to_(to) {
  check(from.camera);
  check(to);
  places_.resize(static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height));
  parallel_ranges(to.height, kRowsAtOnce, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < to.width; ++u) {
        const Eigen::Vector3d ray = to.point(float(u), float(v), 1.F).cast<double>();
        Place& place =
            places_[static_cast<std::size_t>(v) * static_cast<std::size_t>(to.width) + static_cast<std::size_t>(u)];
        place = {kNoPlace, kNoPlace};
        if (const auto bent = distort(from.lens, ray.head<2>())) {
          place = {to_place(bent->x() * double(from.camera.fx) + double(from.camera.cx)),
                   to_place(bent->y() * double(from.camera.fy) + double(from.camera.cy))};
        }
      }
    }
  });
}

DepthImage Rectification::depth(const DepthImage& picture) const {
  expect_size(width_, height_, picture.width(), picture.height());
  DepthImage depth(to_.width, to_.height);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const int u = pixel_of(places_[i].u), v = pixel_of(places_[i].v);
    if (picture.contains(u, v)) depth[i] = picture(u, v);
  }
  return depth;
}

ColourImage Rectification::colour(const ColourImage& picture) const {
  expect_size(width_, height_, picture.width(), picture.height());
  ColourImage colour(to_.width, to_.height);
  parallel_ranges(to_.height, kRowsAtOnce, [&](int begin, int end) {
    const auto width = static_cast<std::size_t>(to_.width);
    for (std::size_t i = static_cast<std::size_t>(begin) * width; i < static_cast<std::size_t>(end) * width; ++i) {
      const Place& place = places_[i];
      if (picture.contains(pixel_of(place.u), pixel_of(place.v))) colour[i] = colour_between(picture, place.u, place.v);
    }
  });
  return colour;
}

std::optional<Rectification> make_rectification(std::optional<LensCamera> distorted, const Camera& to) {
  if (!distorted) return std::nullopt;
  if (distorted->camera.width == 0) distorted->camera.width = to.width;
  if (distorted->camera.height == 0) distorted->camera.height = to.height;
  return Rectification(*distorted, to);
}

}  // namespace vesalius
