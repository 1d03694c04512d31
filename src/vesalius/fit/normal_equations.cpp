#include "vesalius/fit/normal_equations.h"

#include <algorithm>
#include <cmath>

namespace vesalius {
namespace {

constexpr Eigen::Index kRows = 64;  // first size of a block

}  // namespace

NormalEquations::NormalEquations(const FleshModel& flesh)
    : layout_(flesh), blocks_(flesh.bones.size()), matrix_(layout_.size(), layout_.size()), gradient_(layout_.size()) {
  for (int bone = 0; bone < flesh.bone_count(); ++bone) {
    Block& block = blocks_[bone];
    for (int b = bone; b >= 0; b = flesh.bones[b].parent) block.chain.push_back(b);
    block.rows.resize(3 + 3 * static_cast<Eigen::Index>(block.chain.size()) + layout_.shapes, kRows);
    block.residuals.resize(kRows);
  }
}

void NormalEquations::clear(const std::vector<PlacedBone>& placed) {
  placed_ = &placed;
  matrix_.setZero();
  gradient_.setZero();
  cost_ = 0.0;
  for (Block& block : blocks_) block.count = 0;
}

void NormalEquations::add_point(int bone, const Eigen::Vector3d& at, const Eigen::Vector3d& direction,
                                const Eigen::Ref<const Eigen::VectorXd>& by_shape, double residual, double weight) {
  Block& block = blocks_[bone];
  if (block.count == block.rows.cols()) {
    block.rows.conservativeResize(Eigen::NoChange, 2 * block.count);
    block.residuals.conservativeResize(2 * block.count);
  }
  const double root = std::sqrt(weight);
  auto row = block.rows.col(block.count);
  row.head<3>() = root * direction;
  Eigen::Index next = 3;
  for (const int b : block.chain) {
    const PlacedBone& turned = (*placed_)[b];
    // A turn w about the head moves the point by w x (at - head).
    row.segment<3>(next) = root * (turned.global.transpose() * (at - turned.head).cross(direction));
    next += 3;
  }
  row.tail(layout_.shapes) = root * ((*placed_)[bone].head_by_shape.transpose() * direction + by_shape);
  block.residuals[block.count++] = root * residual;
  cost_ += weight * residual * residual;
}

void NormalEquations::add_turns(const std::vector<int>& bones, const Eigen::MatrixXd& derivative,
                                const Eigen::VectorXd& residuals, double weight) {
  const Eigen::MatrixXd square = weight * derivative.transpose() * derivative;
  const Eigen::VectorXd slope = weight * derivative.transpose() * residuals;
  for (std::size_t i = 0; i < bones.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    gradient_.segment<3>(StateLayout::turn(bones[i])) += slope.segment<3>(at);
    for (std::size_t j = 0; j < bones.size(); ++j) {
      matrix_.block<3, 3>(StateLayout::turn(bones[i]), StateLayout::turn(bones[j])) +=
          square.block<3, 3>(at, static_cast<Eigen::Index>(3 * j));
    }
  }
  cost_ += weight * residuals.squaredNorm();
}

void NormalEquations::add_single(int unknown, double derivative, double residual, double weight) {
  matrix_(unknown, unknown) += weight * derivative * derivative;
  gradient_[unknown] += weight * derivative * residual;
  cost_ += weight * residual * residual;
}

void NormalEquations::add_shape(const Eigen::MatrixXd& information, const Eigen::VectorXd& off) {
  matrix_.bottomRightCorner(layout_.shapes, layout_.shapes) += information;
  gradient_.tail(layout_.shapes) += information * off;
  cost_ += off.dot(information * off);
}

void NormalEquations::finish() {
  Eigen::MatrixXd square;
  Eigen::VectorXd slope;
  std::vector<Eigen::Index> unknowns;
  for (const Block& block : blocks_) {
    if (block.count == 0) continue;
    const auto rows = block.rows.leftCols(block.count);
    square.noalias() = rows * rows.transpose();
    slope.noalias() = rows * block.residuals.head(block.count);
    unknowns.clear();
    for (int i = 0; i < 3; ++i) unknowns.push_back(i);
    for (const int b : block.chain) {
      for (int i = 0; i < 3; ++i) unknowns.push_back(StateLayout::turn(b) + i);
    }
    for (int k = 0; k < layout_.shapes; ++k) unknowns.push_back(layout_.shape() + k);
    for (std::size_t j = 0; j < unknowns.size(); ++j) {
      gradient_[unknowns[j]] += slope[static_cast<Eigen::Index>(j)];
      for (std::size_t i = 0; i < unknowns.size(); ++i) {
        matrix_(unknowns[i], unknowns[j]) += square(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
  }
}

Eigen::Matrix3Xd NormalEquations::point_by_state(int bone, const Eigen::Vector3d& at,
                                                 const std::vector<PlacedBone>& placed) const {
  Eigen::Matrix3Xd derivative = Eigen::Matrix3Xd::Zero(3, layout_.size());
  derivative.leftCols<3>().setIdentity();
  for (const int b : blocks_[bone].chain) {
    const PlacedBone& turned = placed[b];
    for (int axis = 0; axis < 3; ++axis) {
      derivative.col(StateLayout::turn(b) + axis) = turned.global.col(axis).cross(at - turned.head);
    }
  }
  derivative.rightCols(layout_.shapes) = placed[bone].head_by_shape;
  return derivative;
}

}  // namespace vesalius
