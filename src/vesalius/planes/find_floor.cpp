#include "vesalius/planes/find_floor.h"

namespace vesalius {
namespace {

constexpr float kLevel = 0.97F;        // cosine: a floor is level within 14 degrees, as up is known
constexpr float kLevelGuessed = 0.5F;  // the same where up is a guess
constexpr float kLeastHeight_m = 0.1F;
constexpr float kMostHeight_m = 6.F;

}  // namespace

std::optional<Plane> find_floor(const std::vector<Plane>& planes, const std::optional<Eigen::Vector3f>& up) {
  const Eigen::Vector3f down = up ? Eigen::Vector3f(-*up) : Eigen::Vector3f(Eigen::Vector3f::UnitY());
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
