#include "vesalius/merge/rigid_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>

namespace vesalius {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kAlike = 25.0;          // pairs that count as one
constexpr double kFarSigmas = 3.0;       // standard deviations at which a pair has a quarter of its weight
constexpr double kUpSigma = 0.005;       // of the floor's direction, radians
constexpr double kHeightSigma_m = 0.01;  // of the height over it

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// A least squares problem in a small turn about the origin and a small step, both after the guess.
struct Normal {
  Matrix6d matrix = 1e-9 * Matrix6d::Identity();
  Vector6d gradient = Vector6d::Zero();

  template <int Rows>
  void add(const Eigen::Matrix<double, Rows, 6>& jacobian, const Eigen::Matrix<double, Rows, 1>& residual,
           double weight) {
    matrix += weight * jacobian.transpose() * jacobian;
    gradient += weight * jacobian.transpose() * residual;
  }
};

void add_points(const Eigen::Isometry3d& guess, const std::vector<PointPair>& pairs, Normal& normal) {
  for (const PointPair& pair : pairs) {
    const Vector3d at = guess * pair.from, off = at - pair.to;
    const double far = off.squaredNorm() / (kFarSigmas * kFarSigmas * pair.variance_m2);
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << -cross_matrix(at), Matrix3d::Identity();
    normal.add<3>(jacobian, off, 1.0 / (kAlike * pair.variance_m2 * (1.0 + far) * (1.0 + far)));
  }
}

void add_floor(const Eigen::Isometry3d& guess, const FloorPair& floor, Normal& normal) {
  const Vector3d up = guess.linear() * floor.from_up;
  Eigen::Matrix<double, 3, 6> turns;
  turns << -cross_matrix(up), Matrix3d::Zero();
  normal.add<3>(turns, up - floor.to_up, 1.0 / (kUpSigma * kUpSigma));
  const Vector3d origin = guess.translation();
  Eigen::Matrix<double, 1, 6> rises;
  rises << -floor.to_up.transpose() * cross_matrix(origin), floor.to_up.transpose();
  const Eigen::Matrix<double, 1, 1> high(floor.to_height_m + floor.to_up.dot(origin) - floor.from_height_m);
  normal.add<1>(rises, high, 1.0 / (kHeightSigma_m * kHeightSigma_m));
}

Eigen::Isometry3d small_motion(const Vector6d& step) {
  const Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (angle > 1e-12) motion.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  motion.translation() = step.tail<3>();
  return motion;
}

}  // namespace

std::optional<Eigen::Isometry3d> rigid_fit(const std::vector<PointPair>& pairs) {
  double weights = 0.0;
  Vector3d to = Vector3d::Zero(), from = Vector3d::Zero();
  for (const PointPair& pair : pairs) {
    weights += 1.0 / pair.variance_m2;
    to += pair.to / pair.variance_m2;
    from += pair.from / pair.variance_m2;
  }
  if (pairs.size() < 3) return std::nullopt;
  to /= weights;
  from /= weights;
  Matrix3d products = Matrix3d::Zero();
  for (const PointPair& pair : pairs) {
    products += (pair.to - to) * (pair.from - from).transpose() / pair.variance_m2;
  }
  const Eigen::JacobiSVD<Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > 1e-6 * svd.singularValues()[0])) return std::nullopt;
  Matrix3d mirror = Matrix3d::Identity();
  mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  Eigen::Isometry3d fit = Eigen::Isometry3d::Identity();
  fit.linear() = svd.matrixU() * mirror * svd.matrixV().transpose();
  fit.translation() = to - fit.linear() * from;
  return fit;
}

Eigen::Isometry3d rigid_refine(Eigen::Isometry3d guess, const std::vector<PointPair>& pairs,
                               const std::optional<FloorPair>& floor) {
  constexpr int kSteps = 10;
  for (int i = 0; i < kSteps; ++i) {
    Normal normal;
    add_points(guess, pairs, normal);
    if (floor) add_floor(guess, *floor, normal);
    guess = small_motion(-normal.matrix.ldlt().solve(normal.gradient)) * guess;
  }
  guess.linear() = Eigen::Quaterniond(guess.linear()).normalized().toRotationMatrix();
  return guess;
}

}  // namespace vesalius
