#include "synth/mesh/oriented_box.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vesalius::synth {
namespace {

/// Returns half the box's extent along a unit direction.
float reach(const OrientedBox& box, const Eigen::Vector3f& axis) {
  return (box.pose.linear().transpose() * axis).cwiseAbs().dot(box.half);
}

}  // namespace

OrientedBox moved(const OrientedBox& box, const Eigen::Isometry3f& motion) { return {motion * box.pose, box.half}; }

float depth_inside(const OrientedBox& box, const Eigen::Vector3f& point) {
  const Eigen::Vector3f local = box.pose.linear().transpose() * (point - box.pose.translation());
  return (box.half - local.cwiseAbs()).minCoeff();
}

bool overlap(const OrientedBox& a, const OrientedBox& b, float slack_m) {
  const Eigen::Vector3f between = b.pose.translation() - a.pose.translation();
  const auto separates = [&](const Eigen::Vector3f& axis) {
    return std::abs(between.dot(axis)) > reach(a, axis) + reach(b, axis) - slack_m;
  };
  for (int i = 0; i < 3; ++i) {
    if (separates(a.pose.linear().col(i)) || separates(b.pose.linear().col(i))) return false;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3f axis = a.pose.linear().col(i).cross(b.pose.linear().col(j));
      if (axis.squaredNorm() > 1e-6F && separates(axis.normalized())) return false;
    }
  }
  return true;
}

bool blocks(const OrientedBox& box, const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  const Eigen::Matrix3f box_from_world = box.pose.linear().transpose();
  const Eigen::Vector3f from = box_from_world * (a - box.pose.translation());
  const Eigen::Vector3f way = box_from_world * (b - a);
  float enter = 0.F, leave = 1.F;
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0.F) {
      if (std::abs(from[axis]) > box.half[axis]) return false;
      continue;
    }
    float t1 = (-box.half[axis] - from[axis]) / way[axis], t2 = (box.half[axis] - from[axis]) / way[axis];
    if (t1 > t2) std::swap(t1, t2);
    enter = std::max(enter, t1);
    leave = std::min(leave, t2);
  }
  return enter <= leave;
}

std::array<Eigen::Vector3f, 8> corners(const OrientedBox& box) {
  std::array<Eigen::Vector3f, 8> result;
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3f sign((i & 1U) != 0 ? 1.F : -1.F, (i & 2U) != 0 ? 1.F : -1.F, (i & 4U) != 0 ? 1.F : -1.F);
    result[i] = box.pose * box.half.cwiseProduct(sign);
  }
  return result;
}

}  // namespace vesalius::synth
