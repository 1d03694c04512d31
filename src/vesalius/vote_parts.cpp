#include "vesalius/vote_parts.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "vesalius/base/pixel_grid.h"

namespace vesalius {
namespace {

/// One of so many votes for a part counts: on rendered people those from nearest are the better ones, also as to
/// hidden parts.
constexpr std::size_t kNearest = 8;

/// A pixel that votes: its point, and its ways to all parts.
struct Voter {
  Eigen::Vector3f point;
  const std::int16_t* ways_mm;
};

float upper_median(std::vector<float>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Finds the places of parts one after the other, in memory that it keeps.
class Poll {
 public:
  explicit Poll(const std::vector<Voter>& voters) : voters_(voters), nearest_(voters.size()) {}

  VotedPart place(std::size_t part) {
    const std::size_t count = choose_nearest(part);
    VotedPart voted;
    for (int axis = 0; axis < 3; ++axis) {
      values_.clear();
      for (std::size_t i = 0; i < count; ++i) {
        const Voter& voter = voters_[nearest_[i].second];
        values_.push_back(voter.point[axis] + 1e-3F * float(voter.ways_mm[3 * part + std::size_t(axis)]));
      }
      voted.centre[axis] = upper_median(values_);
      for (float& value : values_) value = std::abs(value - voted.centre[axis]);
      voted.spread_m = std::max(voted.spread_m, upper_median(values_));
    }
    return voted;
  }

 private:
  /// Puts the voters that are nearest to a part first, and returns how many count.
  std::size_t choose_nearest(std::size_t part) {
    for (std::size_t i = 0; i < voters_.size(); ++i) {
      std::int64_t squared = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t way = voters_[i].ways_mm[3 * part + axis];
        squared += way * way;
      }
      nearest_[i] = {squared, i};
    }
    const std::size_t count = std::max(std::size_t{kLeastPartVotes}, voters_.size() / kNearest);
    std::ranges::nth_element(nearest_, nearest_.begin() + std::ptrdiff_t(count - 1));
    return count;
  }

  const std::vector<Voter>& voters_;
  std::vector<std::pair<std::int64_t, std::size_t>> nearest_;  ///< squared mm, voter
  std::vector<float> values_;
};

}  // namespace

double voted_sigma_m(const VotedPart& part) {
  // Chosen on rendered people, for predicted parts and for fitted bodies; half or twice as much changes little.
  constexpr double kSurest_m = 0.08, kOfSpread = 2.5;
  return std::hypot(kSurest_m, kOfSpread * double(part.spread_m));
}

std::vector<VotedPart> vote_parts(const PartVotes& votes, const Frame& frame, const Mask& person) {
  std::vector<Voter> voters;
  for (int row = 0; row < votes.height; ++row) {
    for (int column = 0; column < votes.width; ++column) {
      const int u = column * kPartVoteStep, v = row * kPartVoteStep;
      if (person(u, v) == 0 || frame.depth(u, v) == 0) continue;
      voters.push_back({point_at(frame.camera, frame.depth, u, v), votes.at(column, row)});
    }
  }
  std::vector<VotedPart> parts;
  if (int(voters.size()) < kLeastPartVotes) return parts;
  Poll poll(voters);
  for (int part = 0; part < votes.parts; ++part) parts.push_back(poll.place(std::size_t(part)));
  return parts;
}

}  // namespace vesalius
