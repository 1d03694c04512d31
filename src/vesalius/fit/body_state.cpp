#include "vesalius/fit/body_state.h"

#include <algorithm>
#include <cmath>

namespace vesalius {
namespace {

constexpr double kTinyAngle = 1e-6;

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace

Eigen::Vector3d log_rotation(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d axis = rotation.w() < 0.0 ? Eigen::Vector3d(-rotation.vec()) : Eigen::Vector3d(rotation.vec());
  const double sine = axis.norm();
  if (sine < kTinyAngle) return 2.0 * axis;
  return 2.0 * std::atan2(sine, std::abs(rotation.w())) / sine * axis;
}

Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < kTinyAngle)
    return Eigen::Quaterniond(1.0, 0.5 * vector.x(), 0.5 * vector.y(), 0.5 * vector.z()).normalized();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

Eigen::Matrix3d log_by_turn(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  const Eigen::Matrix3d skew = cross(vector);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * skew;
  const double half = 0.5 * angle;
  const double share = (1.0 - half / std::tan(half)) / (angle * angle);
  return Eigen::Matrix3d::Identity() + 0.5 * skew + share * skew * skew;
}

BodyState moved(const BodyState& state, const Eigen::VectorXd& step) {
  BodyState next = state;
  next.root += step.segment<3>(StateLayout::root());
  for (std::size_t b = 0; b < next.local.size(); ++b) {
    next.local[b] = (next.local[b] * exp_rotation(step.segment<3>(StateLayout::turn(int(b))))).normalized();
  }
  next.shape += step.tail(next.shape.size());
  return next;
}

std::vector<PlacedBone> place_bones(const FleshModel& flesh, const BodyState& state) {
  const auto shapes = static_cast<Eigen::Index>(flesh.shapes);
  std::vector<PlacedBone> placed(flesh.bones.size());
  for (std::size_t b = 0; b < placed.size(); ++b) {
    const FleshBone& bone = flesh.bones[b];
    PlacedBone& out = placed[b];
    std::copy(bone.mean.begin(), bone.mean.end(), out.numbers.begin());
    for (Eigen::Index k = 0; k < shapes; ++k) {
      for (std::size_t i = 0; i < out.numbers.size(); ++i) {
        out.numbers[i] += state.shape[k] * double(bone.shapes[k][i]);
      }
    }
    const Eigen::Matrix3d local = state.local[b].toRotationMatrix();
    out.head_by_shape.setZero(3, shapes);
    if (bone.parent < 0) {
      out.global = local;
      out.head = state.root;
    } else {
      const PlacedBone& up = placed[bone.parent];
      out.global = up.global * local;
      out.head = up.head + up.global * Eigen::Vector3d(out.numbers[0], out.numbers[1], out.numbers[2]);
      out.head_by_shape = up.head_by_shape;
      for (Eigen::Index k = 0; k < shapes; ++k) {
        const FleshBone::Numbers& by = bone.shapes[k];
        out.head_by_shape.col(k) += up.global * Eigen::Vector3f(by[0], by[1], by[2]).cast<double>();
      }
    }
    out.tail = out.head + out.global * Eigen::Vector3d(out.numbers[3], out.numbers[4], out.numbers[5]);
  }
  return placed;
}

}  // namespace vesalius
