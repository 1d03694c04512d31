#pragma once

#include <Eigen/Core>
#include <cstddef>
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

  static constexpr float kUnitsPerM2 = 16777216.F;  ///< 0.06 mm^2; a pixel at half a metre shows a square millimetre
  static constexpr float kMostUnits = 127.F * kUnitsPerM2;  ///< fits into 32 bits

  void reserve(std::size_t samples);
  /// Adds a sample: a point, the unit normal of the surface about it, how far it may be from its plane, and its area.
  void add(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float thickness_m, float area_m2);

  /// Returns the area, in square metres, of the samples that lie on the plane `normal . p = offset` and whose normals
  /// have a cosine of at least `aligned` to its normal. Each area is divided by the cosine of its slant to the line of
  /// sight, or by `most_slant` where that is larger, and rounded to 1 / kUnitsPerM2, 127 square metres at most. Whole
  /// units are summed: the order of samples does not matter, and every instruction set gives the same.
  float support(const Eigen::Vector3f& normal, float offset, float aligned, float most_slant) const;

  std::size_t size() const { return columns_[kX].size(); }
  const float* column(Column c) const { return columns_[c].data(); }

 private:
  std::vector<float> columns_[kColumns];
};

}  // namespace vesalius
