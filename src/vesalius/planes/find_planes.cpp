#include "vesalius/planes/find_planes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>

#include "vesalius/base/random.h"
#include "vesalius/base/rays.h"
#include "vesalius/frame.h"
#include "vesalius/parallel.h"
#include "vesalius/planes/flat_pieces.h"
#include "vesalius/planes/surface_columns.h"

namespace vesalius {
namespace {

constexpr int kStep = 4;             // every fourth pixel each way is enough for surfaces this large
constexpr int kHypotheses = 150;     // tried for each plane
constexpr float kMostSlant = 0.25F;  // cosine below which a pixel's surface is not stretched further
constexpr int kMaxPlanes = 8;
constexpr float kMinPiece_m2 = 0.6F;  // a smaller connected piece of a plane may be part of a body
constexpr int kRefits = 4;            // least-squares steps from the best hypothesis
constexpr float kLeastRefit = 0.9F;   // share of its surface that a step may not lose
constexpr int kCellReach = 3;         // a plane reaches this many steps beyond its samples
constexpr float kAligned = 0.85F;     // cosine above which a sample's surface is turned like the plane

/// Distance from its plane within which a point at depth z counts as lying on it.
float thickness(const PlaneOptions& options, float z_m) {
  return options.thickness_m + options.thickness_per_z2 * z_m * z_m;
}

struct Sample {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;  ///< unit, of the surface about it
  float area_m2;           ///< across the viewing direction
  int u, v;

  bool on(const Plane& plane, const PlaneOptions& options) const {
    return plane.distance(point) <= thickness(options, point.z()) && std::abs(plane.normal.dot(normal)) >= kAligned;
  }
};

class Surface {
 public:
  Surface(const DepthImage& depth, const Camera& camera) : depth_(depth), camera_(camera), rays_(camera) {}

  bool known(int u, int v) const { return depth_.contains(u, v) && depth_(u, v) != 0; }
  Eigen::Vector3f point(int u, int v) const { return rays_.point(depth_, u, v); }

  /// Normal from neighbours so far apart that the sensor's depth step tilts it by a quarter at most; zero where the
  /// surface ends or bends within that.
  Eigen::Vector3f normal(int u, int v) const {
    const float z = float(depth_(u, v)) * 1e-3F;
    const int reach = std::clamp(int(kNormalReach * z * camera_.fx), 2, 24);
    if (!known(u - reach, v) || !known(u + reach, v) || !known(u, v - reach) || !known(u, v + reach)) {
      return Eigen::Vector3f::Zero();
    }
    const Eigen::Vector3f left = point(u - reach, v), right = point(u + reach, v);
    const Eigen::Vector3f above = point(u, v - reach), below = point(u, v + reach);
    const float bend = std::max((left + right - 2.F * point(u, v)).norm(), (above + below - 2.F * point(u, v)).norm());
    if (bend > 2.F * (kMostBend + kMostBendPerZ2 * z * z)) return Eigen::Vector3f::Zero();
    return (right - left).cross(below - above).normalized();
  }

 private:
  static constexpr float kNormalReach = 0.006F;  // depth step 3 mm z^2 against a baseline of 2 reach z / f
  static constexpr float kMostBend = 0.02F;      // metres between the point and the middle of its neighbours
  static constexpr float kMostBendPerZ2 = 0.005F;
  const DepthImage& depth_;
  const Camera& camera_;
  Rays rays_;
};

std::vector<Sample> take_samples(const DepthImage& depth, const Camera& camera) {
  std::vector<Sample> samples;
  const Surface surface(depth, camera);
  const float pixel_area = float(kStep * kStep) / (camera.fx * camera.fy);
  for (int v = kStep / 2; v < depth.height(); v += kStep) {
    for (int u = kStep / 2; u < depth.width(); u += kStep) {
      if (depth(u, v) == 0) continue;
      const Eigen::Vector3f normal = surface.normal(u, v);
      if (normal.isZero()) continue;
      const float z = float(depth(u, v)) * 1e-3F;
      samples.push_back({surface.point(u, v), normal, pixel_area * z * z, u, v});
    }
  }
  return samples;
}

/// The samples as the kernel takes them.
SurfaceColumns columns_of(const std::vector<Sample>& samples, const PlaneOptions& options) {
  SurfaceColumns columns;
  columns.reserve(samples.size());
  for (const Sample& s : samples) columns.add(s.point, s.normal, thickness(options, s.point.z()), s.area_m2);
  return columns;
}

Plane oriented(const Eigen::Vector3f& normal, const Eigen::Vector3f& through) {
  const float offset = normal.dot(through);
  return offset < 0.F ? Plane{-normal, -offset, 0.F} : Plane{normal, offset, 0.F};
}

/// Plane through a sample and two readings near it in the picture; area -1 where they are in line.
Plane hypothesis(const std::vector<Sample>& samples, const Surface& surface, int reach, Random& random) {
  const Sample& first = samples[random.below(static_cast<std::uint32_t>(samples.size()))];
  const auto near = [&]() -> Eigen::Vector3f {
    const int u = first.u + int(random.below(static_cast<std::uint32_t>(2 * reach + 1))) - reach;
    const int v = first.v + int(random.below(static_cast<std::uint32_t>(2 * reach + 1))) - reach;
    return surface.known(u, v) ? surface.point(u, v) : first.point;
  };
  const Eigen::Vector3f a = near() - first.point;
  const Eigen::Vector3f b = near() - first.point;
  const Eigen::Vector3f normal = a.cross(b);
  if (normal.norm() < 0.2F * a.norm() * b.norm() || normal.norm() < 1e-4F) return {Eigen::Vector3f::UnitZ(), 0.F, -1.F};
  return oriented(normal.normalized(), first.point);
}

/// Least-squares plane through the samples on `plane`.
Plane refit(const std::vector<Sample>& samples, const Plane& plane, const PlaneOptions& options) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const Sample& s : samples) {
    if (!s.on(plane, options)) continue;
    const Eigen::Vector3d p = s.point.cast<double>();
    sum += p;
    products += p * p.transpose();
    count += 1.0;
  }
  if (count < 3.0) return plane;
  const Eigen::Vector3d mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(products / count - mean * mean.transpose());
  return oriented(solver.eigenvectors().col(0).cast<float>(), mean.cast<float>());
}

constexpr float kLevel = 0.97F;        // cosine: a floor is level within 14 degrees, as up is known
constexpr float kLevelGuessed = 0.5F;  // the same where up is a guess
constexpr float kLeastHeight_m = 0.1F;
constexpr float kMostHeight_m = 6.F;

}  // namespace

namespace {

/// The plane with the largest support of those that seeded sampling comes upon.
Plane best_hypothesis(const std::vector<Sample>& samples, const SurfaceColumns& columns, const Surface& surface,
                      int reach, Random& random) {
  std::vector<Plane> tried;
  for (int i = 0; i < kHypotheses; ++i) {
    const Plane plane = hypothesis(samples, surface, reach, random);
    if (plane.area_m2 >= 0.F) tried.push_back(plane);
  }
  parallel_for(int(tried.size()), [&](int i) {
    Plane& plane = tried[i];
    plane.area_m2 = columns.support(plane.normal, plane.offset, kAligned, kMostSlant);
  });
  Plane best{Eigen::Vector3f::UnitZ(), 0.F, 0.F};
  for (const Plane& plane : tried) {
    if (plane.area_m2 > best.area_m2) best = plane;
  }
  return best;
}

std::vector<Plane> planes_of(std::vector<Sample> samples, const DepthImage& depth, const Camera& camera,
                             const PlaneOptions& options) {
  std::vector<Plane> planes;
  const Surface surface(depth, camera);
  const int reach = std::max(6, depth.width() / 12);
  Random random(1);
  while (int(planes.size()) < kMaxPlanes && samples.size() >= 3) {
    const SurfaceColumns columns = columns_of(samples, options);
    Plane best = best_hypothesis(samples, columns, surface, reach, random);
    if (best.area_m2 < options.min_area_m2) break;
    for (int i = 0; i < kRefits; ++i) {
      Plane fitted = refit(samples, best, options);
      fitted.area_m2 = columns.support(fitted.normal, fitted.offset, kAligned, kMostSlant);
      if (fitted.area_m2 < kLeastRefit * best.area_m2) break;
      best = fitted;
    }
    planes.push_back(best);
    std::erase_if(samples, [&](const Sample& s) { return s.on(best, options); });
  }
  std::ranges::stable_sort(planes, [](const Plane& a, const Plane& b) { return a.area_m2 > b.area_m2; });
  return planes;
}

/// Cells of kStep x kStep pixels within kCellReach of a sample that lies on a plane, as a bit a plane.
Image<std::uint64_t> cells_near(const std::vector<Sample>& samples, const std::vector<Plane>& planes,
                                const DepthImage& depth, const PlaneOptions& options) {
  Image<std::uint64_t> cells(depth.width() / kStep + 1, depth.height() / kStep + 1, 0);
  for (const Sample& s : samples) {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (s.on(planes[i], options)) cells(s.u / kStep, s.v / kStep) |= std::uint64_t{1} << i;
    }
  }
  Image<std::uint64_t> wide(cells.width(), cells.height(), 0);
  const auto spread = [](const Image<std::uint64_t>& from, int du, int dv, Image<std::uint64_t>& to) {
    for (int v = 0; v < from.height(); ++v) {
      for (int u = 0; u < from.width(); ++u) {
        for (int k = -kCellReach; from(u, v) != 0 && k <= kCellReach; ++k) {
          if (to.contains(u + k * du, v + k * dv)) to(u + k * du, v + k * dv) |= from(u, v);
        }
      }
    }
  };
  spread(cells, 1, 0, wide);
  cells.fill(0);
  spread(wide, 0, 1, cells);
  return cells;
}

/// As flat_pixels; `planes` were found in the samples.
Mask pixels_on(const std::vector<Plane>& planes, const std::vector<Sample>& samples, const DepthImage& depth,
               const Camera& camera, const PlaneOptions& options) {
  Mask out(depth.width(), depth.height(), 0);
  if (planes.empty()) return out;
  Image<std::uint8_t> plane_of(depth.width(), depth.height(), 0);
  const Image<std::uint64_t> cells = cells_near(samples, planes, depth, options);
  const Surface surface(depth, camera);
  parallel_ranges(depth.height(), 16, [&](int begin, int end) {
    const int width = depth.width();
    for (int v = begin; v < end; ++v) {
      const std::uint64_t* near = cells.row(v / kStep);
      for (int u = 0; u < width; ++u) {
        std::uint64_t bits = near[u / kStep];
        if (bits == 0 || depth(u, v) == 0) continue;
        const Eigen::Vector3f p = surface.point(u, v);
        const float thick = thickness(options, p.z());
        for (; bits != 0; bits &= bits - 1) {
          const int i = std::countr_zero(bits);
          if (planes[i].distance(p) > thick) continue;
          out(u, v) = 1;
          plane_of(u, v) = static_cast<std::uint8_t>(i);
        }
      }
    }
  });
  const auto area_m2 = [&](const std::vector<int>& pixels) {
    double area = 0.0;
    for (const int pixel : pixels) {
      const int u = pixel % depth.width(), v = pixel / depth.width();
      const Eigen::Vector3f p = surface.point(u, v);
      const float slant = std::abs(planes[plane_of(u, v)].normal.dot(p)) / p.norm();
      area += double(p.z() * p.z() / std::max(slant, kMostSlant));
    }
    return float(area / double(camera.fx * camera.fy));
  };
  const double surely_large_mm2 = 1e6 * double(kMinPiece_m2 * camera.fx * camera.fy);
  return without_body_pieces(depth, out, surely_large_mm2,
                             [&](const std::vector<int>& pixels) { return area_m2(pixels) >= kMinPiece_m2; });
}

}  // namespace

std::vector<Plane> find_planes(const DepthImage& depth, const Camera& camera, const PlaneOptions& options) {
  return planes_of(take_samples(depth, camera), depth, camera, options);
}

FlatSurfaces find_flat_surfaces(const DepthImage& depth, const Camera& camera, const PlaneOptions& options) {
  const std::vector<Sample> samples = take_samples(depth, camera);
  FlatSurfaces flat{planes_of(samples, depth, camera, options), {}};
  flat.pixels = pixels_on(flat.planes, samples, depth, camera, options);
  return flat;
}

Mask pixels_on(const std::vector<Plane>& planes, const DepthImage& depth, const Camera& camera,
               const PlaneOptions& options) {
  return pixels_on(planes, take_samples(depth, camera), depth, camera, options);
}

Mask flat_pixels(const DepthImage& depth, const Camera& camera, const PlaneOptions& options) {
  return find_flat_surfaces(depth, camera, options).pixels;
}

std::optional<Plane> find_floor(const std::vector<Plane>& planes, const std::optional<Eigen::Vector3f>& up,
                                const Eigen::Vector3f& guess) {
  const Eigen::Vector3f down = -up.value_or(guess);
  const float least = up ? kLevel : kLevelGuessed;
  std::optional<Plane> floor;
  for (const Plane& plane : planes) {
    const bool level = plane.normal.dot(down) >= least;  // normals point away from the camera
    const bool below = plane.offset >= kLeastHeight_m && plane.offset <= kMostHeight_m;
    if (level && below && (!floor || plane.offset > floor->offset)) floor = plane;
  }
  return floor;
}

}  // namespace vesalius
