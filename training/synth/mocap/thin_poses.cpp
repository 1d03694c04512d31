#include "synth/mocap/thin_poses.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

/// The entries of the joints' rotation matrices, 9 for each joint. A turn by some angle changes an entry by at most the
/// angle's chord.
constexpr int kEntries = 9 * kBoneCount;
/// The levels of the tree, each of which splits by one entry. 40 levels leave few bones out.
constexpr int kLevels = 40;
constexpr std::size_t kLeaf = 12;
/// The number of poses from which entries are chosen.
constexpr std::size_t kSample = 2000;

using Entries = Eigen::Matrix<float, kEntries, 1>;
using Coordinates = std::array<float, kLevels>;
using Rotations = std::array<Eigen::Quaternionf, kBoneCount>;

Rotations rotations_of(const Pose& pose) {
  Rotations out = pose.local;
  out[0] = without_yaw(out[0]);
  for (const Eigen::Quaternionf& q : out) {
    if (!q.coeffs().allFinite()) throw Error("thin_poses: a pose has a number that is not finite");
  }
  return out;
}

Entries entries_of(const Rotations& rotations) {
  Entries out;
  for (int b = 0; b < kBoneCount; ++b) {
    const Eigen::Matrix3f m = rotations[b].toRotationMatrix();
    out.segment<9>(9 * b) = Eigen::Map<const Eigen::Matrix<float, 9, 1>>(m.data());
  }
  return out;
}

/// Returns the entries that distinguish poses best. Each is the one that varies most after subtracting what the earlier
/// ones explain (Cholesky decomposition of the covariance with pivots).
std::array<int, kLevels> telling_entries(std::span<const Pose> poses) {
  const std::size_t step = poses.size() / kSample + 1;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kEntries);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(kEntries, kEntries);
  int count = 0;
  for (std::size_t i = 0; i < poses.size(); i += step, ++count) {
    const Eigen::VectorXd e = entries_of(rotations_of(poses[i])).cast<double>();
    sum += e;
    squares.selfadjointView<Eigen::Lower>().rankUpdate(e);
  }
  Eigen::MatrixXd rest = squares.selfadjointView<Eigen::Lower>();
  rest = rest / count - (sum / count) * (sum / count).transpose();
  std::array<int, kLevels> chosen{};
  for (int& entry : chosen) {
    Eigen::Index pivot = 0;
    const double variance = rest.diagonal().maxCoeff(&pivot);
    entry = int(pivot);
    if (variance < 1e-9) continue;  // the chosen entries determine the others
    const Eigen::VectorXd column = rest.col(pivot);
    rest -= column * column.transpose() / variance;
  }
  return chosen;
}

/// Tells whether a pose is nearer than an angle to one of the poses added before. Each level of the tree divides one
/// coordinate into cells as wide as the angle's chord, so every near pose is in the same cell or beside it.
class NearPoses {
 public:
  NearPoses(std::array<int, kLevels> entries, float min_angle_rad)
      : entries_(entries),
        min_angle_(min_angle_rad),
        cos_half_(std::cos(0.5F * min_angle_rad)),
        // The small addition allows for rounding.
        cell_(2.F * std::sin(0.5F * std::min(min_angle_rad, 3.14159265F)) + 1e-5F),
        nodes_(1) {}

  /// Adds the pose unless a near one was added before. Returns whether it was added.
  bool add_if_far(const Pose& pose) {
    const Rotations rotations = rotations_of(pose);
    const Entries all = entries_of(rotations);
    Coordinates at;
    for (std::size_t l = 0; l < kLevels; ++l) at[l] = all[entries_[l]];
    if (near(rotations, at)) return false;
    kept_.push_back({rotations, at});
    insert(int(kept_.size()) - 1);
    return true;
  }

 private:
  struct Kept {
    Rotations rotations;
    Coordinates at;
  };
  struct Child {
    int cell;
    int node;
  };
  struct Node {
    bool leaf = true;
    std::vector<int> poses;       ///< poses of a leaf
    std::vector<Child> children;  ///< children of an inner node, by rising cells
  };
  struct Place {
    int node;
    std::size_t level;
  };

  int cell_of(float coordinate) const { return int(std::floor(coordinate / cell_)); }

  bool near(const Rotations& pose, const Coordinates& at) {
    open_.assign(1, {0, 0});
    while (!open_.empty()) {
      const Place place = open_.back();
      open_.pop_back();
      const Node& node = nodes_[place.node];
      for (const int i : node.poses) {
        if (near(pose, kept_[i].rotations)) return true;
      }
      if (node.leaf) continue;
      const int low = cell_of(at[place.level] - cell_), high = cell_of(at[place.level] + cell_);
      auto child = std::ranges::lower_bound(node.children, low, {}, &Child::cell);
      for (; child != node.children.end() && child->cell <= high; ++child) {
        open_.push_back({child->node, place.level + 1});
      }
    }
    return false;
  }

  /// Returns whether largest_angle(a, b) < min_angle_. The dot product decides unless the result is too close.
  bool near(const Rotations& a, const Rotations& b) const {
    constexpr float kTooClose = 2e-6F;
    for (std::size_t j = 0; j < kBoneCount; ++j) {
      const float dot = std::abs(a[j].dot(b[j]));
      if (dot < cos_half_ - kTooClose) return false;
      if (dot < cos_half_ + kTooClose && a[j].angularDistance(b[j]) >= min_angle_) return false;
    }
    return true;
  }

  void insert(int pose) {
    Place place{0, 0};
    while (!nodes_[place.node].leaf) place = descend(place, pose);
    std::vector<int>& poses = nodes_[place.node].poses;
    poses.push_back(pose);
    if (poses.size() <= kLeaf || place.level == kLevels) return;
    const std::vector<int> moved = std::exchange(poses, {});
    nodes_[place.node].leaf = false;
    for (const int i : moved) nodes_[descend(place, i).node].poses.push_back(i);
  }

  /// Returns the child for a pose, and creates it if there is none.
  Place descend(const Place& place, int pose) {
    const int cell = cell_of(kept_[pose].at[place.level]);
    std::vector<Child>& children = nodes_[place.node].children;
    auto child = std::ranges::lower_bound(children, cell, {}, &Child::cell);
    if (child == children.end() || child->cell != cell) {
      child = children.insert(child, {cell, int(nodes_.size())});
      const int made = child->node;
      nodes_.emplace_back();  // invalidates `children`
      return {made, place.level + 1};
    }
    return {child->node, place.level + 1};
  }

  std::array<int, kLevels> entries_;
  float min_angle_;
  float cos_half_;
  float cell_;
  std::vector<Kept> kept_;
  std::vector<Node> nodes_;
  std::vector<Place> open_;
};

}  // namespace

std::vector<int> thin_poses(std::span<const Pose> poses, float min_angle_rad) {
  if (!(min_angle_rad >= 0.F && std::isfinite(min_angle_rad))) {
    throw Error("thin_poses: expected an angle of 0 or more radians");
  }
  std::vector<int> kept;
  if (poses.empty()) return kept;
  NearPoses near(telling_entries(poses), min_angle_rad);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (min_angle_rad == 0.F || near.add_if_far(poses[i])) kept.push_back(int(i));
  }
  return kept;
}

}  // namespace vesalius::synth
