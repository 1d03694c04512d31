#include "io/lens/lens.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <string>

#include "io/files/plain_text.h"
#include "io/lens/fixed_point.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using Eigen::Vector2d;

/// Rays beyond 84 degrees from the axis are in nobody's pinhole picture.
constexpr double kLongestRay = 10.0;
constexpr double kRayStep = 1.0 / 512;

Vector2d bend(LensModel model, const std::array<double, 8>& k, Vector2d ray) {
  if (model == LensModel::kannala_brandt) {
    bend_kannala_brandt(k, ray.x(), ray.y());
  } else if (model == LensModel::modified_brown_conrady) {
    bend_modified_brown_conrady(k, ray.x(), ray.y());
  } else if (model != LensModel::pinhole) {
    bend_brown_conrady(k, ray.x(), ray.y());
  }
  return ray;
}

/// Returns the length of the longest ray up to which longer rays are bent further out.
double one_to_one(LensModel model, std::array<double, 8> k) {
  if (model != LensModel::kannala_brandt) k[2] = k[3] = 0.0;  // the radial terms decide
  double last = 0.0;
  double length = 0.0;
  while (length < kLongestRay) {
    const double bent = bend(model, k, {length + kRayStep, 0.0}).x();
    if (!(bent > last)) break;
    last = bent;
    length += kRayStep;
  }
  return length;
}

/// Returns the point that `bend` takes to `target`, by Newton's method; nothing where it does not come to one.
std::optional<Vector2d> unbend(const Lens& lens, const Vector2d& target) {
  constexpr int kMostSteps = 30;
  constexpr double kExact = 1e-12, kClose = 1e-7, kDifference = 1e-6;
  Vector2d at = target;
  // The bend of a fisheye squeezes; starting within it keeps the first step short.
  if (lens.model == LensModel::kannala_brandt)
    at *= std::tan(std::min(target.norm(), 1.5)) / std::max(target.norm(), kExact);
  for (int step = 0; step < kMostSteps; ++step) {
    const Vector2d off = bend(lens.model, lens.k, at) - target;
    if (!off.allFinite()) return std::nullopt;
    if (off.norm() < kExact) return at;
    Eigen::Matrix2d slope;
    for (int i = 0; i < 2; ++i) {
      const Vector2d d = kDifference * Vector2d::Unit(i);
      slope.col(i) = (bend(lens.model, lens.k, at + d) - bend(lens.model, lens.k, at - d)) / (2 * kDifference);
    }
    if (std::abs(slope.determinant()) < kExact) return std::nullopt;
    at -= slope.inverse() * off;
  }
  if ((bend(lens.model, lens.k, at) - target).norm() < kClose) return at;
  return std::nullopt;
}

struct ModelName {
  std::string_view name;
  LensModel model;
  std::size_t most;  ///< coefficients
};

constexpr std::array<ModelName, 12> kModels{{{"plumbbob", LensModel::brown_conrady, 5},
                                             {"radtan", LensModel::brown_conrady, 5},
                                             {"brownconrady", LensModel::brown_conrady, 5},
                                             {"rationalpolynomial", LensModel::brown_conrady, 8},
                                             {"", LensModel::brown_conrady, 8},
                                             {"modifiedbrownconrady", LensModel::modified_brown_conrady, 5},
                                             {"inversebrownconrady", LensModel::modified_brown_conrady, 5},
                                             {"equidistant", LensModel::kannala_brandt, 4},
                                             {"fisheye", LensModel::kannala_brandt, 4},
                                             {"kannalabrandt", LensModel::kannala_brandt, 4},
                                             {"kannalabrandt4", LensModel::kannala_brandt, 4},
                                             {"pinhole", LensModel::pinhole, 0}}};

constexpr int kRectifiedRows = 16;

void expect_distorted_size(int width, int height, int picture_width, int picture_height) {
  if (picture_width == width && picture_height == height) return;
  throw Error(fmt::format("a picture of {}x{} pixels, expected {}x{} of the calibration", picture_width, picture_height,
                          width, height));
}

}  // namespace

std::optional<Lens> make_lens(std::string_view model, const std::vector<double>& coefficients) {
  const auto is_zero = [](double c) { return c == 0.0; };
  if (std::ranges::all_of(coefficients, is_zero)) return Lens{};
  const auto named = std::ranges::find(kModels, letters_and_digits(model), &ModelName::name);
  if (named == kModels.end()) return std::nullopt;
  const std::size_t count = std::min(coefficients.size(), named->most);
  if (!std::all_of(coefficients.begin() + static_cast<std::ptrdiff_t>(count), coefficients.end(), is_zero)) {
    return std::nullopt;
  }
  Lens lens;
  lens.model = named->model;
  std::copy_n(coefficients.begin(), count, lens.k.begin());
  if (!std::ranges::all_of(lens.k, [](double c) { return std::isfinite(c); })) return std::nullopt;
  lens.reach = one_to_one(lens.model, lens.k);
  return lens;
}

std::optional<Vector2d> distort(const Lens& lens, const Vector2d& ray) {
  if (!(ray.norm() <= lens.reach)) return std::nullopt;
  return bend(lens.model, lens.k, ray);
}

std::optional<Vector2d> undistort(const Lens& lens, const Vector2d& distorted) {
  std::optional<Vector2d> ray = unbend(lens, distorted);
  if (!ray || !(ray->norm() <= lens.reach)) return std::nullopt;
  return ray;
}

Rectification::Rectification(const LensCamera& from, const Camera& to)
    : width_(from.camera.width), height_(from.camera.height), to_(to) {
  check(from.camera);
  check(to);
  places_.resize(static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height));
  parallel_ranges(to.height, kRectifiedRows, [&](int begin, int end) {
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
  expect_distorted_size(width_, height_, picture.width(), picture.height());
  DepthImage depth(to_.width, to_.height);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const int u = pixel_of(places_[i].u), v = pixel_of(places_[i].v);
    if (picture.contains(u, v)) depth[i] = picture(u, v);
  }
  return depth;
}

ColourImage Rectification::colour(const ColourImage& picture) const {
  expect_distorted_size(width_, height_, picture.width(), picture.height());
  ColourImage colour(to_.width, to_.height);
  parallel_ranges(to_.height, kRectifiedRows, [&](int begin, int end) {
    const auto width = static_cast<std::size_t>(to_.width);
    for (std::size_t i = static_cast<std::size_t>(begin) * width; i < static_cast<std::size_t>(end) * width; ++i) {
      const Place& place = places_[i];
      if (picture.contains(pixel_of(place.u), pixel_of(place.v))) colour[i] = colour_between(picture, place.u, place.v);
    }
  });
  return colour;
}

std::optional<double> whole_ratio(std::int64_t from_width, std::int64_t from_height, std::int64_t width,
                                  std::int64_t height) {
  const bool has_size = width > 0 && height > 0 && from_width > 0 && from_height > 0;
  if (!has_size || from_width * height != from_height * width) return std::nullopt;
  if (from_width % width != 0 && width % from_width != 0) return std::nullopt;
  return double(from_width) / double(width);
}

std::optional<Rectification> make_rectification(std::optional<LensCamera> distorted, const Camera& to) {
  if (!distorted) return std::nullopt;
  if (distorted->camera.width == 0) distorted->camera.width = to.width;
  if (distorted->camera.height == 0) distorted->camera.height = to.height;
  return Rectification(*distorted, to);
}

}  // namespace vesalius
