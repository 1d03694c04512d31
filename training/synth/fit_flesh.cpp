#include "synth/fit_flesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "synth/body/surface_parts.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/parallel.h"

namespace vesalius::synth {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kStations = FleshBone::kStations;
constexpr int kNumbers = FleshBone::kNumbers;

/// A point of a body's surface in the T, from the head of its bone.
struct SurfacePoint {
  Bone bone;
  Eigen::Vector3f at;
  float area_m2;
};

int axis_of(Bone bone) {
  Index axis = 0;
  rest_direction(bone).cwiseAbs().maxCoeff(&axis);
  return int(axis);
}

bool is_right(Bone bone) { return bone_name(bone).starts_with("r_"); }

/// A body in the T: where its bones are, and its surface. What belongs to nobody is left out.
struct RestBody {
  std::array<Eigen::Vector3f, kBoneCount> offset, tail;
  std::vector<SurfacePoint> surface;
};

RestBody rest_body(const Poser& poser) {
  const PosedBody posed = poser.pose(Pose{});
  RestBody body;
  for (int b = 0; b < kBoneCount; ++b) {
    const auto up = index(parent(static_cast<Bone>(b)));
    // The root is midway between the hips, where the pelvis of any rig can be told.
    const auto head = [&](int bone) {
      return bone == 0
                 ? Eigen::Vector3f(0.5F * (posed.joints[index(Bone::l_thigh)] + posed.joints[index(Bone::r_thigh)]))
                 : posed.joints[bone];
    };
    body.offset[b] = b == 0 ? Eigen::Vector3f::Zero().eval() : (head(b) - head(up)).eval();
    body.tail[b] = posed.ends[b] - head(b);
    if (b == 0) body.tail[b] = posed.joints[index(Bone::spine)] - head(b);
  }
  const BodyMesh& mesh = poser.mesh();
  const std::vector<Bone> bones = surface_bones(mesh);
  const BodyTopology& topology = *mesh.topology;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    if (topology.part[t] == kBackground) continue;
    const Triangle& triangle = topology.triangles[t];
    const Eigen::Vector3f a = posed.vertices[triangle[0]], b = posed.vertices[triangle[1]],
                          c = posed.vertices[triangle[2]];
    const int bone = index(bones[t]);
    const Eigen::Vector3f head =
        bone == 0 ? Eigen::Vector3f(0.5F * (posed.joints[index(Bone::l_thigh)] + posed.joints[index(Bone::r_thigh)]))
                  : posed.joints[bone];
    body.surface.push_back({bones[t], (a + b + c) / 3.F - head, 0.5F * (b - a).cross(c - a).norm()});
  }
  return body;
}

/// A number with the weight of what it stands for.
struct Weighted {
  float value;
  float weight;
};

/// Returns the value below which `share` of the weight lies.
float quantile(std::vector<Weighted>& values, float share) {
  std::ranges::sort(values, {}, &Weighted::value);
  const float all = std::accumulate(values.begin(), values.end(), 0.F,
                                    [](float sum, const Weighted& value) { return sum + value.weight; });
  float below = 0.F;
  for (const Weighted& value : values) {
    below += value.weight;
    if (below >= share * all) return value.value;
  }
  return values.empty() ? 0.F : values.back().value;
}

float along(const SurfacePoint& point, const Eigen::Vector3f& tail, int axis) { return point.at[axis] / tail[axis]; }

/// Returns the places along a bone between which nearly all of its surface lies in all bodies.
std::array<float, kStations> stations_of(const std::vector<RestBody>& bodies, Bone bone) {
  constexpr float kEnds = 0.03F;
  std::vector<Weighted> places;
  for (const RestBody& body : bodies) {
    for (const SurfacePoint& point : body.surface) {
      if (point.bone != bone) continue;
      places.push_back({along(point, body.tail[index(bone)], axis_of(bone)), point.area_m2});
    }
  }
  const float from = quantile(places, kEnds), to = quantile(places, 1.F - kEnds);
  return {from, 0.5F * (from + to), to};
}

/// Returns centre and half width along an axis across the bone, of the surface about a station.
std::array<float, 2> width_at(const RestBody& body, Bone bone, const std::array<float, kStations>& stations,
                              int station, int across) {
  constexpr float kRim = 0.02F;
  const float reach = 0.35F * (stations[1] - stations[0]);
  std::vector<Weighted> values;
  for (const SurfacePoint& point : body.surface) {
    if (point.bone != bone) continue;
    const float place = along(point, body.tail[index(bone)], axis_of(bone));
    if (std::abs(place - stations[station]) <= reach) values.push_back({point.at[across], point.area_m2});
  }
  const float low = quantile(values, kRim), high = quantile(values, 1.F - kRim);
  return {0.5F * (low + high), std::max(0.5F * (high - low), 0.01F)};
}

FleshBone::Numbers measure(const RestBody& body, Bone bone, const std::array<float, kStations>& stations) {
  FleshBone::Numbers numbers{};
  const int b = index(bone);
  std::copy_n(body.offset[b].data(), 3, numbers.begin());
  std::copy_n(body.tail[b].data(), 3, numbers.begin() + 3);
  const std::array<int, 2> across = axes_across(axis_of(bone));
  for (int station = 0; station < kStations; ++station) {
    for (int i = 0; i < 2; ++i) {
      const auto [centre, half] = width_at(body, bone, stations, station, across[i]);
      numbers[6 + 4 * station + i] = centre;
      numbers[6 + 4 * station + 2 + i] = half;
    }
  }
  return numbers;
}

/// Returns the mean of a bone's numbers and of the mirror image of its partner's.
FleshBone::Numbers symmetric(const RestBody& body, Bone bone, const std::array<float, kStations>& stations) {
  FleshBone::Numbers numbers = measure(body, bone, stations);
  const FleshBone::Numbers other = vesalius::mirrored(measure(body, mirror(bone), stations), axis_of(bone));
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = 0.5F * (numbers[i] + other[i]);
  return numbers;
}

/// The bones that the text lists: those of the left and of the middle.
std::vector<Bone> listed_bones() {
  std::vector<Bone> bones;
  for (int b = 0; b < kBoneCount; ++b) {
    if (!is_right(static_cast<Bone>(b))) bones.push_back(static_cast<Bone>(b));
  }
  return bones;
}

struct FleshPopulation {
  std::vector<std::array<float, kStations>> stations;  ///< [listed bone]
  VectorXd mean;                                       ///< the numbers of all listed bones
  MatrixXd factors;                                    ///< columns: what a standard deviation of a factor adds
};

FleshPopulation population_of(const std::vector<RestBody>& bodies, int factors) {
  // Lengths are the same in all of a person's frames and weigh more than what clothes do to widths.
  constexpr double kLengthWeight = 3.0;
  const std::vector<Bone> bones = listed_bones();
  FleshPopulation population;
  for (const Bone bone : bones) population.stations.push_back(stations_of(bodies, bone));
  MatrixXd numbers(static_cast<Index>(bones.size() * kNumbers), static_cast<Index>(bodies.size()));
  parallel_for(int(bodies.size()), [&](int i) {
    for (std::size_t b = 0; b < bones.size(); ++b) {
      const FleshBone::Numbers of_bone = symmetric(bodies[i], bones[b], population.stations[b]);
      for (int k = 0; k < kNumbers; ++k) numbers(static_cast<Index>(b * kNumbers + k), i) = double(of_bone[k]);
    }
  });
  VectorXd weights(numbers.rows());
  for (Index row = 0; row < weights.size(); ++row) weights[row] = row % kNumbers < 6 ? kLengthWeight : 1.0;
  population.mean = numbers.rowwise().mean();
  const MatrixXd centred = weights.asDiagonal() * (numbers.colwise() - population.mean);
  // The bodies are fewer than the numbers: the factors follow from the bodies' inner products.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(centred.transpose() * centred / double(bodies.size()));
  population.factors.resize(numbers.rows(), factors);
  for (int k = 0; k < factors; ++k) {
    const Index column = solver.eigenvalues().size() - 1 - k;
    VectorXd factor = centred * solver.eigenvectors().col(column) / std::sqrt(double(bodies.size()));
    factor = weights.cwiseInverse().asDiagonal() * factor;
    if (factor.sum() < 0.0) factor = -factor;  // larger coefficients are larger bodies
    population.factors.col(k) = factor;
  }
  return population;
}

Eigen::Vector3d rotation_vector(const Eigen::Quaternionf& rotation) {
  const Eigen::AngleAxisd turn(rotation.cast<double>().normalized());
  const double angle = std::remainder(turn.angle(), 2.0 * std::numbers::pi);
  return angle * turn.axis();
}

/// Returns the rotation vectors of the bones in a pose.
VectorXd rotations_of(const Pose& pose, const std::vector<Bone>& bones) {
  VectorXd rotations(static_cast<Index>(3 * bones.size()));
  for (std::size_t i = 0; i < bones.size(); ++i) {
    rotations.segment<3>(static_cast<Index>(3 * i)) = rotation_vector(pose[bones[i]]);
  }
  return rotations;
}

struct Gaussian {
  double weight = 0.0;
  VectorXd mean;
  MatrixXd covariance;
};

/// Fits a mixture of Gaussians to columns by expectation maximisation, from means at random columns.
std::vector<Gaussian> fit_mixture(const MatrixXd& samples, int components, Random random) {
  constexpr int kRounds = 40;
  constexpr double kLeastDeviation = 0.07;  // radians: motion capture and our bones differ by some degrees
  const Index size = samples.rows();
  const MatrixXd floor = kLeastDeviation * kLeastDeviation * MatrixXd::Identity(size, size);
  const VectorXd mean = samples.rowwise().mean();
  const MatrixXd centred = samples.colwise() - mean;
  const MatrixXd all = centred * centred.transpose() / double(samples.cols());
  std::vector<Gaussian> mixture;
  for (int k = 0; k < components; ++k) {
    const auto drawn = static_cast<Index>(random.below(static_cast<std::uint32_t>(samples.cols())));
    mixture.push_back({1.0 / components, samples.col(drawn), all + floor});
  }
  MatrixXd shares(components, samples.cols());
  for (int round = 0; round < kRounds; ++round) {
    for (int k = 0; k < components; ++k) {
      const Eigen::LLT<MatrixXd> root(mixture[k].covariance);
      const MatrixXd lower = root.matrixL();
      const MatrixXd whitened = lower.triangularView<Eigen::Lower>().solve(samples.colwise() - mixture[k].mean);
      const double log_density = std::log(mixture[k].weight) - lower.diagonal().array().log().sum();
      shares.row(k) = (log_density - 0.5 * whitened.colwise().squaredNorm().array()).matrix();
    }
    for (Index i = 0; i < samples.cols(); ++i) {
      shares.col(i) = (shares.col(i).array() - shares.col(i).maxCoeff()).exp();
      shares.col(i) /= shares.col(i).sum();
    }
    for (int k = 0; k < components; ++k) {
      const double total = std::max(shares.row(k).sum(), 1.0);
      mixture[k].weight = total / double(samples.cols());
      const VectorXd share = shares.row(k).transpose() / total;
      mixture[k].mean.noalias() = samples * share;
      const MatrixXd off = samples.colwise() - mixture[k].mean;
      mixture[k].covariance = off * share.asDiagonal() * off.transpose() + floor;
    }
  }
  double sum = 0.0;
  for (const Gaussian& gaussian : mixture) sum += gaussian.weight;
  for (Gaussian& gaussian : mixture) gaussian.weight /= sum;
  return mixture;
}

/// The limbs whose bones move together, those of the left side for both.
const std::vector<std::vector<Bone>>& limbs() {
  static const std::vector<std::vector<Bone>> kLimbs = {
      {Bone::spine, Bone::chest, Bone::neck, Bone::head},
      {Bone::l_clavicle, Bone::l_upper_arm, Bone::l_forearm, Bone::l_hand},
      {Bone::l_thigh, Bone::l_shin, Bone::l_foot}};
  return kLimbs;
}

/// Returns the rotations of a limb in all poses and in their mirror images: columns.
MatrixXd limb_samples(const std::vector<Pose>& poses, const std::vector<Bone>& bones) {
  MatrixXd samples(static_cast<Index>(3 * bones.size()), static_cast<Index>(2 * poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    samples.col(static_cast<Index>(2 * i)) = rotations_of(poses[i], bones);
    samples.col(static_cast<Index>(2 * i + 1)) = rotations_of(mirrored(poses[i]), bones);
  }
  return samples;
}

std::string list(const double* numbers, std::size_t count) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) texts.push_back(fmt::format("{:.4f}", numbers[i] + 0.0));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::vector<double> values(numbers.begin(), numbers.end());
  return list(values.data(), values.size());
}

std::string bones_toml(const FleshPopulation& population, const std::vector<Pose>& poses) {
  constexpr float kRare = 0.002F;  // share of poses beyond a joint's range: errors of motion capture
  const std::vector<Bone> bones = listed_bones();
  std::string text;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const Bone bone = bones[b];
    const auto row = static_cast<Index>(b * kNumbers);
    text += fmt::format("\n[[bone]]\nname = \"{}\"\n", bone_name(bone));
    if (bone != Bone::pelvis) text += fmt::format("parent = \"{}\"\n", bone_name(parent(bone)));
    text += fmt::format("axis = \"{}\"\n", std::string_view("xyz")[axis_of(bone)]);
    text += "stations = " + list(population.stations[b]) + "\n";
    text += "mean = " + list(population.mean.data() + row, kNumbers) + "\nshapes = [\n";
    for (Index k = 0; k < population.factors.cols(); ++k) {
      const VectorXd factor = population.factors.col(k).segment(row, kNumbers);
      text += "  " + list(factor.data(), kNumbers) + ",\n";
    }
    text += "]\n";
    MatrixXd turns = bone == Bone::pelvis ? MatrixXd::Zero(3, 1) : limb_samples(poses, {bone});
    std::array<double, 3> low{}, high{};
    for (int i = 0; i < 3; ++i) {
      std::vector<Weighted> values;
      for (Index c = 0; c < turns.cols(); ++c) values.push_back({float(turns(i, c)), 1.F});
      low[i] = double(quantile(values, kRare));
      high[i] = double(quantile(values, 1.F - kRare));
    }
    text += "low = " + list(low) + "\nhigh = " + list(high) + "\n";
  }
  return text;
}

std::string limbs_toml(const std::vector<Pose>& poses, const FleshFitOptions& options) {
  const auto count = int(limbs().size());
  std::vector<std::vector<Gaussian>> mixtures(count);
  parallel_for(count, [&](int i) {
    mixtures[i] = fit_mixture(limb_samples(poses, limbs()[i]), options.components, Random(options.seed, 100 + i));
  });
  std::string text;
  for (int i = 0; i < count; ++i) {
    std::vector<std::string> names;
    for (const Bone bone : limbs()[i]) names.push_back(fmt::format("\"{}\"", bone_name(bone)));
    text += fmt::format("\n[[limb]]\nbones = [{}]\n", fmt::join(names, ", "));
    for (const Gaussian& gaussian : mixtures[i]) {
      std::vector<double> triangle;
      for (Index row = 0; row < gaussian.mean.size(); ++row) {
        for (Index column = 0; column <= row; ++column) triangle.push_back(gaussian.covariance(row, column));
      }
      text += fmt::format("[[limb.component]]\nweight = {:.4f}\n", std::max(gaussian.weight, 1e-4));
      text += "mean = " + list(gaussian.mean) + "\ncovariance = " + list(triangle) + "\n";
    }
  }
  return text;
}

}  // namespace

std::string fitted_flesh_toml(const Generator& generator, const FleshFitOptions& options) {
  std::vector<RestBody> bodies(options.bodies);
  parallel_for(options.bodies, [&](int i) { bodies[i] = rest_body(generator.body(i)); });
  std::vector<Pose> poses;
  Random random(options.seed);
  for (int i = 0; i < options.poses; ++i) poses.push_back(generator.draw_pose(random).pose);
  return fmt::format(
             "# Bones, flesh and poses of a population (docs/tracking.md), by tools/fit_body.\n"
             "# Metres and radians; the right side mirrors the left one.\nshapes = {}\n",
             options.shapes) +
         bones_toml(population_of(bodies, options.shapes), poses) + limbs_toml(poses, options);
}

}  // namespace vesalius::synth
