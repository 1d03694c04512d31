#include "train/leaves/fit_facing.h"

#include <algorithm>
#include <cmath>

namespace vesalius {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSteps = 600;
constexpr double kPrior = 2e-3;  ///< of the squared weights, for features of standard deviation 1

/// Divides each row by its sum after taking exponentials.
void softmax(MatrixXd& logits) {
  for (Index i = 0; i < logits.rows(); ++i) {
    logits.row(i) = (logits.row(i).array() - logits.row(i).maxCoeff()).exp();
    logits.row(i) /= logits.row(i).sum();
  }
}

}  // namespace

FacingModel fit_facing(const std::vector<FacingSample>& samples, int parts, int headings) {
  FacingModel model{headings, parts, {}};
  if (headings == 0 || samples.empty()) return model;
  std::vector<double> count(headings, 0.0);
  for (const FacingSample& sample : samples) count[sample.heading] += 1.0;
  if (std::ranges::any_of(count, [](double n) { return n == 0.0; })) return model;
  const auto people = static_cast<Index>(samples.size());
  const auto features = static_cast<Index>(model.features());
  MatrixXd x(people, features);
  MatrixXd truth = MatrixXd::Zero(people, headings);
  VectorXd weight(people);
  for (Index i = 0; i < people; ++i) {
    const std::vector<float>& of_person = samples[i].features;
    x.row(i) = Eigen::Map<const Eigen::RowVectorXf>(of_person.data(), features).cast<double>();
    truth(i, samples[i].heading) = 1.0;
    weight[i] = 1.0 / std::sqrt(count[samples[i].heading]);
  }
  weight /= weight.sum();
  VectorXd scale = (x.array().square().colwise().sum() / double(people)).sqrt().transpose();
  for (Index f = 0; f < features; ++f) scale[f] = scale[f] > 1e-6 ? 1.0 / scale[f] : 0.0;
  x = x * scale.asDiagonal();
  // Gradient descent with Nesterov's momentum; a softmax's curvature is at most half of the features' largest variance.
  const double curvature = 0.5 * (x.transpose() * weight.asDiagonal() * x).norm() + kPrior;
  MatrixXd w = MatrixXd::Zero(features, headings);
  MatrixXd ahead = w;
  for (int step = 0; step < kSteps; ++step) {
    MatrixXd error = x * ahead;
    softmax(error);
    error = weight.asDiagonal() * (error - truth);
    const MatrixXd next = ahead - (x.transpose() * error + kPrior * ahead) / curvature;
    ahead = next + (double(step) / (step + 3.0)) * (next - w);
    w = next;
  }
  w = scale.asDiagonal() * w;
  model.weights.resize(static_cast<std::size_t>(features) * headings);
  for (int h = 0; h < headings; ++h) {
    for (Index f = 0; f < features; ++f) model.weights[h * features + f] = float(w(f, h));
  }
  return model;
}

}  // namespace vesalius
