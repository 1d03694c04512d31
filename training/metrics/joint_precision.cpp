#include "metrics/joint_precision.h"

#include <algorithm>
#include <cstddef>

#include "metrics/joint_metrics.h"

namespace vesalius {
namespace {

/// Returns the true joint nearest to a proposal that is within the tolerance and not taken, or -1.
int nearest_free(const Eigen::Vector3f& at, std::size_t joint, const std::vector<std::vector<Eigen::Vector3f>>& truth,
                 const std::vector<char>& taken) {
  int nearest = -1;
  double least = kJointTolerance_m;
  for (std::size_t person = 0; person < truth.size(); ++person) {
    const auto distance = double((truth[person][joint] - at).norm());
    if (taken[person] != 0 || distance > least) continue;
    least = distance;
    nearest = int(person);
  }
  return nearest;
}

}  // namespace

JointPrecision::Of& JointPrecision::of(const std::string& name) {
  const auto found = std::ranges::find(joints_, name, &Of::name);
  return found != joints_.end() ? *found : joints_.emplace_back(Of{name, 0, {}});
}

void JointPrecision::add(const std::vector<std::string>& names, std::vector<JointProposals> proposals,
                         const std::vector<std::vector<Eigen::Vector3f>>& truth, std::size_t counted) {
  std::ranges::stable_sort(proposals, [](const auto& a, const auto& b) { return a.score > b.score; });
  for (std::size_t joint = 0; joint < names.size(); ++joint) {
    if (std::ranges::any_of(truth, [&](const auto& person) { return person[joint].hasNaN(); })) continue;
    Of& sums = of(names[joint]);
    sums.known += static_cast<long>(std::min(counted, truth.size()));
    std::vector<char> taken(truth.size(), 0);
    for (const JointProposals& proposal : proposals) {
      if (proposal.joints[joint].hasNaN()) continue;
      const int person = nearest_free(proposal.joints[joint], joint, truth, taken);
      if (person >= 0) taken[person] = 1;
      if (person >= int(counted)) continue;
      sums.proposals.push_back({proposal.score, person >= 0});
    }
  }
}

void JointPrecision::add(const JointPrecision& frames) {
  for (const Of& other : frames.joints_) {
    Of& sums = of(other.name);
    sums.known += other.known;
    sums.proposals.insert(sums.proposals.end(), other.proposals.begin(), other.proposals.end());
  }
}

std::vector<std::pair<std::string, double>> JointPrecision::averages() const {
  std::vector<std::pair<std::string, double>> out;
  for (const Of& joint : joints_) {
    if (joint.known == 0) continue;
    std::vector<Judged> surest = joint.proposals;
    std::ranges::sort(surest, [](const Judged& a, const Judged& b) { return a.score > b.score; });
    std::vector<std::pair<double, double>> curve;  // right ones, precision; a point for every score that occurs
    double right = 0.0;
    for (std::size_t i = 0; i < surest.size(); ++i) {
      right += surest[i].right ? 1.0 : 0.0;
      if (i + 1 < surest.size() && surest[i + 1].score == surest[i].score) continue;
      curve.emplace_back(right, right / double(i + 1));
    }
    double area = 0.0, best = 0.0;  // from the right: the best precision at this recall or more
    for (std::size_t i = curve.size(); i-- > 0;) {
      best = std::max(best, curve[i].second);
      area += best * (curve[i].first - (i > 0 ? curve[i - 1].first : 0.0));
    }
    out.emplace_back(joint.name, area / double(joint.known));
  }
  return out;
}

}  // namespace vesalius
