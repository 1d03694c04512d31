#include "io/lens/colour_registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "io/lens/fixed_point.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kRegisteredRows = 16;
constexpr int kMostCellBits = 8;
constexpr std::uint16_t kFar = std::numeric_limits<std::uint16_t>::max();

/// Readings so much behind the nearest one in a cell are hidden by it. Less is the slope or the noise of one surface,
/// and with a colour camera 10 cm away such surfaces are less than a pixel apart.
constexpr int kLeastBehind_mm = 30;
constexpr int kShareBehind = 32;  // of the distance

/// Where a pixel of depth lands in the colour picture, and how far from the colour camera it is.
struct Landing {
  std::int32_t u = kNoPlace, v = kNoPlace;
  std::uint16_t z_mm = 0;
};

template <class T>
void expect_camera_size(const Camera& camera, const Image<T>& picture, const char* what) {
  if (picture.width() == camera.width && picture.height() == camera.height) return;
  throw Error(fmt::format("{} of {}x{} pixels, expected {}x{} of its calibration", what, picture.width(),
                          picture.height(), camera.width, camera.height));
}

void keep_nearer(std::uint16_t& value, std::uint16_t to) {
  const std::atomic_ref<std::uint16_t> shared(value);
  std::uint16_t now = shared.load(std::memory_order_relaxed);
  while (to < now && !shared.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
  }
}

}  // namespace

ColourRegistration::ColourRegistration(const Camera& depth, const LensCamera& colour,
                                       const Eigen::Isometry3d& colour_from_depth)
    : depth_(depth), colour_(colour), colour_from_depth_(colour_from_depth.cast<float>()) {
  check(depth);
  check(colour.camera);
  std::ranges::transform(colour_.lens.k, k_.begin(), [](double k) { return float(k); });
  // At any distance, one pixel of depth covers so many of colour.
  while (float(1 << cell_bits_) < colour.camera.fx / depth.fx && cell_bits_ < kMostCellBits) ++cell_bits_;
}

ColourImage ColourRegistration::operator()(const DepthImage& depth, const ColourImage& colour) const {
  expect_camera_size(depth_, depth, "depth");
  expect_camera_size(colour_.camera, colour, "colour");
  const Camera& to = colour_.camera;
  const auto reach = float(colour_.lens.reach);
  const float reach2 = reach * reach;
  Image<std::uint16_t> nearest(((to.width - 1) >> cell_bits_) + 1, ((to.height - 1) >> cell_bits_) + 1, kFar);
  Image<Landing> landings(depth.width(), depth.height());
  const Eigen::Matrix3f turn = colour_from_depth_.linear();
  const Eigen::Vector3f shift_mm = 1000.F * colour_from_depth_.translation();

  parallel_ranges(depth.height(), kRegisteredRows, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      const Eigen::Vector3f row = turn.col(1) * ((float(v) - depth_.cy) / depth_.fy) + turn.col(2);
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0) continue;
        const Eigen::Vector3f ray = turn.col(0) * ((float(u) - depth_.cx) / depth_.fx) + row;
        const Eigen::Vector3f point_mm = float(depth(u, v)) * ray + shift_mm;
        if (!(point_mm.z() >= 1.F && point_mm.z() < float(kFar))) continue;
        float x = point_mm.x() / point_mm.z(), y = point_mm.y() / point_mm.z();
        if (!(x * x + y * y <= reach2)) continue;
        if (colour_.lens.model == LensModel::brown_conrady) bend_brown_conrady(k_, x, y);
        if (colour_.lens.model == LensModel::modified_brown_conrady) bend_modified_brown_conrady(k_, x, y);
        if (colour_.lens.model == LensModel::kannala_brandt) bend_kannala_brandt(k_, x, y);
        const Landing landing{to_place(x * to.fx + to.cx), to_place(y * to.fy + to.cy),
                              static_cast<std::uint16_t>(point_mm.z())};
        const int cu = pixel_of(landing.u), cv = pixel_of(landing.v);
        if (!colour.contains(cu, cv)) continue;
        landings(u, v) = landing;
        keep_nearer(nearest(cu >> cell_bits_, cv >> cell_bits_), landing.z_mm);
      }
    }
  });

  ColourImage registered(depth.width(), depth.height());
  parallel_ranges(depth.height(), kRegisteredRows, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        const Landing& landing = landings(u, v);
        if (landing.u == kNoPlace) continue;
        const int front = nearest(pixel_of(landing.u) >> cell_bits_, pixel_of(landing.v) >> cell_bits_);
        const bool hidden = landing.z_mm - front > std::max(kLeastBehind_mm, front / kShareBehind);
        if (!hidden) registered(u, v) = colour_between(colour, landing.u, landing.v);
      }
    }
  });
  return registered;
}

}  // namespace vesalius
