#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "vesalius/camera.h"
#include "vesalius/image.h"

namespace vesalius {

/// How a lens bends the rays that a pinhole camera sees. A ray is where it crosses the plane z = 1: (x, y).
enum class LensModel {
  pinhole,                 ///< not at all
  brown_conrady,           ///< radial and tangential terms move the ray: k1 k2 p1 p2 k3 k4 k5 k6, in OpenCV's order
  modified_brown_conrady,  ///< the tangential terms act on what the radial ones moved: k1 k2 p1 p2 k3
  kannala_brandt           ///< a fisheye: a polynomial of the angle, k1 k2 k3 k4
};

struct Lens {
  LensModel model = LensModel::pinhole;
  std::array<double, 8> k{};  ///< coefficients in the order of the model
  /// Length of the longest ray that the model bends one to one. Beyond it polynomials fold back, and nothing is seen.
  double reach = std::numeric_limits<double>::infinity();

  friend bool operator==(const Lens&, const Lens&) = default;
};

/// A camera as it is: a pinhole camera behind a lens.
struct LensCamera {
  Camera camera;
  Lens lens;
};

/// Returns the lens of a model as ROS (plumb_bob, rational_polynomial, equidistant), Foxglove (kannala_brandt) and
/// the makers of cameras ("Modified Brown Conrady") name it; case and separators do not count. A model without a name
/// is that of plumb_bob or rational_polynomial, by the number of coefficients. "Inverse Brown Conrady" is the modified
/// model: librealsense describes it as one that undoes a lens, but its functions project by it as by the other one. All
/// coefficients 0 are a pinhole. Returns nothing for another model, or coefficients that it does not have.
std::optional<Lens> make_lens(std::string_view model, const std::vector<double>& coefficients);

/// Returns where a lens puts a ray; nothing beyond its reach.
std::optional<Eigen::Vector2d> distort(const Lens& lens, const Eigen::Vector2d& ray);

/// Returns the ray that `distort` puts there; nothing where there is none.
std::optional<Eigen::Vector2d> undistort(const Lens& lens, const Eigen::Vector2d& distorted);

/// Moves a ray by the terms of Brown and Conrady. OpenCV's documentation of calib3d has the formula.
template <class Real>
inline void bend_brown_conrady(const std::array<Real, 8>& k, Real& x, Real& y) {
  const Real xx = x * x, yy = y * y, xy = Real(2) * x * y, r2 = xx + yy;
  const Real radial =
      (Real(1) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (Real(1) + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  x = x * radial + k[2] * xy + k[3] * (r2 + Real(2) * xx);
  y = y * radial + k[3] * xy + k[2] * (r2 + Real(2) * yy);
}

/// Moves a ray by the same terms, the tangential ones after the radial ones, as librealsense's
/// rs2_project_point_to_pixel does.
template <class Real>
inline void bend_modified_brown_conrady(const std::array<Real, 8>& k, Real& x, Real& y) {
  const Real r2 = x * x + y * y, radial = Real(1) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  x *= radial;
  y *= radial;
  const Real xx = x * x, yy = y * y, xy = Real(2) * x * y;
  x += k[2] * xy + k[3] * (r2 + Real(2) * xx);
  y += k[3] * xy + k[2] * (r2 + Real(2) * yy);
}

/// Moves a ray to the radius that the polynomial of Kannala and Brandt (2006) gives its angle.
template <class Real>
inline void bend_kannala_brandt(const std::array<Real, 8>& k, Real& x, Real& y) {
  const Real radius = std::sqrt(x * x + y * y);
  if (radius < Real(1e-8)) return;
  const Real angle = std::atan(radius), a2 = angle * angle;
  const Real scale = angle * (Real(1) + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3])))) / radius;
  x *= scale;
  y *= scale;
}

/// Returns by how much larger than `width` x `height` a picture of the first two sides is, of the same shape, if that
/// is a whole number or one over it: what decimation leaves of a calibration.
std::optional<double> whole_ratio(std::int64_t from_width, std::int64_t from_height, std::int64_t width,
                                  std::int64_t height);

/// Turns pictures of a camera with a lens into those of a pinhole camera in its place. Where each pixel comes from is
/// worked out once.
class Rectification {
 public:
  /// `to` may differ from `from` in size, focal length and principal point. Throws Error if one has no size.
  Rectification(const LensCamera& from, const Camera& to);

  /// Returns the nearest reading to each pixel, so that no depths are mixed; 0 where the lens does not see.
  DepthImage depth(const DepthImage& picture) const;
  /// Returns colour between the four nearest pixels; black where the lens does not see.
  ColourImage colour(const ColourImage& picture) const;

 private:
  /// A place in the picture in 256ths of a pixel.
  struct Place {
    std::int32_t u = 0, v = 0;
  };
  int width_, height_;  ///< width and height of the pictures that go in
  Camera to_;
  /// Where each pixel that comes out was; outside of the picture where the lens does not see.
  std::vector<Place> places_;
};

/// Returns what turns pictures of a camera that distorts into those of `to`; nothing if there is none. A camera without
/// a size has that of `to`.
std::optional<Rectification> make_rectification(std::optional<LensCamera> distorted, const Camera& to);

/// Returns colour without the distortion of its camera, if that has one.
inline ColourImage rectified(const std::optional<Rectification>& rectification, ColourImage colour) {
  return rectification ? rectification->colour(colour) : std::move(colour);
}

}  // namespace vesalius
