#include "synth/body/limb.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vesalius::synth {
namespace {

/// Returns a radial estimate of the distance to an ellipsoid with these half axes. It is exact on the surface and for
/// spheres.
float ellipsoid_distance(const Eigen::Vector3f& offset, const Eigen::Vector3f& half_axes) {
  const float scaled = offset.cwiseQuotient(half_axes).norm();
  if (scaled < 1e-3F) return -half_axes.minCoeff();
  return offset.norm() * (1.F - 1.F / scaled);
}

}  // namespace

LimbDistance::LimbDistance(const Limb& limb) {
  float before = 0.F;
  const std::size_t count = std::max<std::size_t>(limb.stations.size(), 2) - 1;
  for (std::size_t k = 0; k < count; ++k) {
    const Station& from = limb.stations[k];
    const Station& to = limb.stations[std::min(k + 1, limb.stations.size() - 1)];
    Piece piece;
    piece.head = from.centre;
    piece.from = from;
    piece.to = to;
    piece.length = (to.centre - from.centre).norm();
    piece.along = piece.length > 0.F ? Eigen::Vector3f((to.centre - from.centre) / piece.length) : limb.axis;
    piece.across = (limb.wide_axis - limb.wide_axis.dot(piece.along) * piece.along).normalized();
    piece.deep = piece.along.cross(piece.across);
    piece.before = before;
    piece.reach = std::max({from.wide, from.deep, from.cap, to.wide, to.deep, to.cap});
    before += piece.length;
    pieces_.push_back(piece);
  }
}

LimbPoint LimbDistance::nearest_on(const Piece& piece, const Eigen::Vector3f& p, float best) const {
  const Eigen::Vector3f from_head = p - piece.head;
  const float place = from_head.dot(piece.along);
  const float along = std::clamp(place, 0.F, piece.length);
  const Eigen::Vector3f e = from_head - along * piece.along;
  if (e.norm() - piece.reach > best) return {best, 0.F};
  const float share = piece.length > 0.F ? along / piece.length : 0.F;
  const Eigen::Vector3f half_axes(std::lerp(piece.from.wide, piece.to.wide, share),
                                  std::lerp(piece.from.deep, piece.to.deep, share),
                                  place < 0.F ? piece.from.cap : piece.to.cap);
  const Eigen::Vector3f offset(e.dot(piece.across), e.dot(piece.deep), e.dot(piece.along));
  return {ellipsoid_distance(offset, half_axes), piece.before + along};
}

LimbPoint LimbDistance::nearest(const Eigen::Vector3f& p, float most_m) const {
  LimbPoint best{most_m, 0.F};
  for (const Piece& piece : pieces_) {
    const LimbPoint here = nearest_on(piece, p, best.distance_m);
    if (here.distance_m < best.distance_m) best = here;
  }
  return best;
}

Bounds bounds(const Limb& limb) {
  Bounds box{Eigen::Vector3f::Constant(std::numeric_limits<float>::max()),
             Eigen::Vector3f::Constant(std::numeric_limits<float>::lowest())};
  for (const Station& s : limb.stations) {
    const float reach = std::max({s.wide, s.deep, s.cap});
    box.low = box.low.cwiseMin(s.centre - Eigen::Vector3f::Constant(reach));
    box.high = box.high.cwiseMax(s.centre + Eigen::Vector3f::Constant(reach));
  }
  return box;
}

}  // namespace vesalius::synth
