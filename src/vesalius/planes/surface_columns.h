#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace vesalius {

/// Samples of the surfaces in a picture, as the kernel takes them: a column for each property.
class SurfaceColumns {
 public:
  enum Column { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kThickness, kArea, kDistance, kColumns };

  /// The plane (x, y, z) . p = offset, and what `support` says of the rest.
  struct Query {
    float x, y, z, offset, aligned, most_slant;
  };

  void reserve(std::size_t samples);
  /// Adds a sample: a point, the unit normal of the surface about it, how far it may be from its plane, and its area.
  void add(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float thickness_m, float area_m2);

  /// Returns the area of the samples that lie on the plane `normal . p = offset` and whose normals have a cosine of at
  /// least `aligned` to its normal. Each area is divided by the cosine of its slant to the line of sight, or by
  /// `most_slant` where that is larger. The sum is that of doubles added one after the other, the same from every
  /// instruction set.
  float support(const Eigen::Vector3f& normal, float offset, float aligned, float most_slant) const;

  std::size_t size() const { return columns_[kX].size(); }
  const float* column(Column c) const { return columns_[c].data(); }

 private:
  /// Returns whether no sum of the areas is rounded, in whatever order.
  bool sums_are_exact(float most_slant) const;

  std::vector<float> columns_[kColumns];
  float smallest_ = std::numeric_limits<float>::infinity();
  double total_ = 0.0;
};

}  // namespace vesalius
