#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// A bone with its flesh, at rest in the body's frame: x to the person's left, y up, z to the front; the rest pose is a
/// T. The flesh is a stack of ellipses across the bone with rounded ends.
struct FleshBone {
  static constexpr int kStations = 3;
  /// The numbers that depend on the body's shape, in metres: the head from the parent's head (x, y, z), the tail from
  /// the head (x, y, z), then for each station the centre and the half width across the bone along both other axes.
  static constexpr int kNumbers = 6 + 4 * kStations;
  using Numbers = std::array<float, kNumbers>;

  std::string name;
  int parent = -1;  ///< -1 for the root; parents come first
  int mirror = -1;  ///< the same bone on the other side; itself on the middle line
  int axis = 1;     ///< the axis of the body's frame along which the bone lies at rest
  std::array<float, kStations> stations{0.F, 0.5F, 1.F};  ///< places along the bone, rising: 0 its head, 1 its tail
  Numbers mean{};
  std::vector<Numbers> shapes;  ///< what a standard deviation of each shape adds
  /// Ranges of the rotation vector from the parent, radians.
  std::array<float, 3> low{}, high{};
};

/// The ellipse of flesh across a bone at one of its stations, in the bone's frame, metres.
template <class Number>
struct FleshEllipse {
  Eigen::Vector3<Number> centre = Eigen::Vector3<Number>::Zero();
  std::array<int, 2> across{};   ///< its two axes
  std::array<Number, 2> half{};  ///< half of its width along them
};

/// Returns the two axes across the bone, in rising order.
constexpr std::array<int, 2> axes_across(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

/// Returns the ellipse at a station for numbers of the bone, such as those of somebody's shape.
template <class Number>
FleshEllipse<Number> ellipse_of(const FleshBone& bone, const std::array<Number, FleshBone::kNumbers>& numbers,
                                int station) {
  FleshEllipse<Number> ellipse;
  ellipse.across = axes_across(bone.axis);
  ellipse.centre[bone.axis] = static_cast<Number>(bone.stations[station]) * numbers[3 + bone.axis];
  for (int i = 0; i < 2; ++i) {
    ellipse.centre[ellipse.across[i]] = numbers[6 + 4 * station + i];
    ellipse.half[i] = numbers[8 + 4 * station + i];
  }
  return ellipse;
}

/// How the bones of a limb are turned in a population of poses: a mixture of Gaussians over their rotation vectors.
struct LimbPrior {
  struct Component {
    float weight = 0.F;         ///< they sum to 1
    Eigen::VectorXd mean;       ///< radians, three numbers for each bone
    Eigen::MatrixXd whitening;  ///< lower triangular; |whitening (x - mean)| is Mahalanobis' distance
    double log_density = 0.0;   ///< logarithm of weight and density at the mean
  };
  std::vector<int> bones;
  std::vector<Component> components;  ///< the most usual first
};

/// A population of bodies and their poses, to which fit_body fits people. It comes from rendered people
/// (`vesalius_fit_body flesh`) and is the same for all body models with surface rules.
struct FleshModel {
  int shapes = 0;  ///< coefficients of a body's shape, each of mean 0 and standard deviation 1
  std::vector<FleshBone> bones;
  std::vector<LimbPrior> limbs;

  int bone_count() const { return int(bones.size()); }
  /// Returns the index of the bone of that name, or -1 if there is none.
  int find_bone(std::string_view name) const;
};

/// Parses a flesh model. Throws Error naming `source`, line and expectation.
FleshModel parse_flesh_model(std::string_view toml, const std::string& source);

/// Returns the flesh model that comes with the program (data/bodies/flesh.toml).
const FleshModel& builtin_flesh();

/// Returns the numbers of a bone for a shape.
FleshBone::Numbers numbers_of(const FleshBone& bone, const Eigen::VectorXd& shape);

/// Returns the height of a body of this shape that stands upright, metres: from the soles to the top of the head.
double stature(const FleshModel& flesh, const Eigen::VectorXd& shape);

/// Returns the mirror image of a bone's numbers (x -> -x).
FleshBone::Numbers mirrored(FleshBone::Numbers numbers, int axis);

}  // namespace vesalius
