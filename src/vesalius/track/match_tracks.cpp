#include "vesalius/track/match_tracks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/base/assign_pairs.h"
#include "vesalius/prior.h"

namespace vesalius {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr float kGate = 16.F;           // squared deviations in space: one person in 900 moves further
constexpr float kUsualSigma_m = 0.15F;  // of a prediction; less certain ones must not attract everybody
constexpr float kMostPlaceCost = 8.F;   // for those beyond the gate who look the same
constexpr float kRun_m_s = 3.F;         // nobody gets further in a room
constexpr float kReach_m = 0.6F;        // error of a place, and a camera's turn
constexpr float kLookWeight = 15.F;     // a difference of 0.1 counts as much as one of 1.7 deviations in space
constexpr float kMostLookCost = 6.F;
constexpr float kMaskWeight = 1.F;
constexpr float kLeastOverlap = 0.03F;
constexpr float kMostSizeCost = 3.F;
constexpr float kSizeGate = 9.F;

bool within_reach(const Track& track, const Sighting& sighting, double time_s) {
  const auto passed_s = float(std::clamp(time_s - track.seen_s, 0.0, 1e6));
  return (sighting.trunk.position - track.place_position).norm() <= kReach_m + kRun_m_s * passed_s;
}

/// Returns how much of the expected mask and the person's is shared, or -1 if that is unknown.
float overlap(const Mask& expected, const Person& person) {
  if (expected.empty() || !expected.same_size(person.mask)) return -1.F;
  return shared_pixels(expected, person.mask);
}

/// How much an overlap speaks against one person; half of the masks of neighbouring frames is plenty.
float overlap_cost(float share) {
  return share < 0.F ? 0.F : -kMaskWeight * std::log(std::clamp(2.F * share, kLeastOverlap, 1.F));
}

TrackSize size_of(const Sighting& sighting) {
  TrackSize size;
  if (sighting.scale) size.add_scale(*sighting.scale);
  return size;
}

}  // namespace

std::vector<int> match_tracks(const Eigen::MatrixXf& costs, float unmatched) {
  // Each row has a column of its own to be without partner in. Forbidden pairs cost more than that, so that none is
  // ever taken.
  const double alone = double(unmatched);
  const double forbidden = alone + 1.0;
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(costs.rows(), costs.cols() + costs.rows(), forbidden);
  all.rightCols(costs.rows()).diagonal().setConstant(alone);
  for (Eigen::Index column = 0; column < costs.cols(); ++column) {
    for (Eigen::Index row = 0; row < costs.rows(); ++row) {
      if (costs(row, column) < unmatched) all(row, column) = double(costs(row, column));
    }
  }
  std::vector<int> match = assign_pairs(all);
  for (int& column : match) {
    if (column >= costs.cols()) column = -1;
  }
  return match;
}

float match_cost(const Track& track, const Sighting& sighting, const Appearance* appearance, double time_s,
                 float same_look) {
  const float distance2 = track.motion.distance2(sighting.trunk.position, sighting.trunk.sigma_m);
  const std::optional<float> look = look_distance(track.look.histogram(), sighting.look, appearance);
  const float shared = overlap(track.expected, sighting.person);
  const bool inside = distance2 <= kGate || shared >= kKnownOverlap;
  const bool alike = look && *look <= same_look && within_reach(track, sighting, time_s);
  if (!std::isfinite(distance2) || (!inside && !alike)) return kNever;
  const float sigma2 =
      track.motion.sigma_m() * track.motion.sigma_m() + sighting.trunk.sigma_m * sighting.trunk.sigma_m;
  const float spread = std::max(0.F, 1.5F * std::log(sigma2 / (kUsualSigma_m * kUsualSigma_m)));
  const float place = std::min(0.5F * distance2 + spread, kMostPlaceCost);
  const float look_cost = look ? std::min(kLookWeight * *look, kMostLookCost) : 0.F;
  const float size = std::min(0.5F * TrackSize::distance2(track.size, size_of(sighting)), kMostSizeCost);
  return place + look_cost + overlap_cost(shared) + size;
}

std::optional<float> return_cost(const Track& lost, const Sighting& sighting, const Appearance* appearance,
                                 double time_s, float same_look) {
  const std::optional<float> look = look_distance(lost.look.histogram(), sighting.look, appearance);
  if (!look || *look > same_look) return std::nullopt;
  if (TrackSize::distance2(lost.size, size_of(sighting)) > kSizeGate) return std::nullopt;
  const bool known_time = time_s >= lost.seen_s;  // otherwise it was set back, and places say nothing
  if (known_time && !within_reach(lost, sighting, time_s)) return std::nullopt;
  return look;
}

}  // namespace vesalius
