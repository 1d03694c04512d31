#include "vesalius/group_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr int kSample = 900;
constexpr int kEvery = 3;             // votes of the sample from one start to the next
constexpr float kSameStart_m = 0.1F;  // starts this near climb to the same peak
constexpr int kShiftRounds = 4;
constexpr float kVoteReach_m = 0.3F;  // of the kernel, which is much like a Gaussian of 10 cm
constexpr float kLeastMass_m2 = 0.004F;
constexpr float kApart_m = 0.3F;  // least distance of two peaks
constexpr float kNeighbour_m = 1.F;
constexpr float kLeastGroupShare = 0.15F;  // least mass of a peak as a share of its lightest neighbour's
constexpr float kOwn_m = 0.6F;             // most distance of a vote from its peak

/// A pixel that votes.
struct Vote {
  int column = 0, row = 0;  ///< of the picture of votes
  Vector3f at = Vector3f::Zero();
  float area_m2 = 0.F;  ///< surface for which it stands
  double body = 0.0;
  std::uint8_t group = kBackground;
};

struct Peak {
  Vector3f at = Vector3f::Zero();
  float mass_m2 = 0.F;
};

/// Returns whether a pixel is likelier body than not, so that it votes and belongs to a group.
bool is_body(std::optional<double> share) { return share && *share > 0.5; }

std::vector<Vote> collect_votes(const Posteriors& posteriors, const Frame& frame, int parts) {
  std::vector<Vote> votes;
  for (int row = 0; row < posteriors.votes.height(); ++row) {
    for (int column = 0; column < posteriors.votes.width(); ++column) {
      const int u = column * kVoteStep, v = row * kVoteStep;
      const std::optional<double> share = body_share(posteriors, u, v, parts);
      if (frame.depth(u, v) == 0 || !is_body(share)) continue;
      const float side_m = float(frame.depth(u, v)) * 1e-3F * float(kVoteStep);
      votes.push_back({column, row, voted_middle(posteriors.votes, frame, column, row),
                       side_m * side_m / (frame.camera.fx * frame.camera.fy), *share});
    }
  }
  return votes;
}

/// Votes that stand for all others: where each votes, and for how much surface.
struct VoteSample {
  Eigen::ArrayXf x, y, z, area_m2;
  Vector3f at(Eigen::Index i) const { return {x[i], y[i], z[i]}; }
};

/// Returns at most kSample votes, evenly spread over the surface that votes: of near people some, of far ones all.
VoteSample choose_sample(const std::vector<Vote>& votes) {
  double all = 0.0;
  for (const Vote& vote : votes) all += double(vote.area_m2);
  const double step = all / kSample;
  double passed = 0.0, reached = 0.5 * step;
  std::vector<std::array<float, 4>> chosen;
  for (const Vote& vote : votes) {
    passed += double(vote.area_m2);
    if (passed < reached) continue;
    const double steps = std::floor((passed - reached) / step) + 1.0;
    reached += steps * step;
    chosen.push_back({vote.at.x(), vote.at.y(), vote.at.z(), float(steps * step)});
  }
  const Eigen::Map<const Eigen::Array4Xf> columns(chosen.empty() ? nullptr : chosen.front().data(), 4,
                                                  static_cast<Eigen::Index>(chosen.size()));
  return {columns.row(0), columns.row(1), columns.row(2), columns.row(3)};
}

/// Returns the places from which to climb: some of the sample, apart from each other.
std::vector<Vector3f> choose_starts(const VoteSample& votes) {
  std::vector<Vector3f> starts;
  for (Eigen::Index i = 0; i < votes.x.size(); i += kEvery) {
    const Vector3f at = votes.at(i);
    const auto near = [&](const Vector3f& start) { return (start - at).squaredNorm() < kSameStart_m * kSameStart_m; };
    if (std::ranges::none_of(starts, near)) starts.push_back(at);
  }
  return starts;
}

/// Returns where the densest votes near `at` are. The kernel is a polynomial, the same on all processors.
Peak climb(const VoteSample& votes, Vector3f at) {
  constexpr float kSquare = 1.F / (kVoteReach_m * kVoteReach_m);
  for (int round = 0;; ++round) {
    const Eigen::ArrayXf x = votes.x - at.x(), y = votes.y - at.y(), z = votes.z - at.z();
    const Eigen::ArrayXf left = (1.F - kSquare * (x.square() + y.square() + z.square())).max(0.F);
    const Eigen::ArrayXf weight = votes.area_m2 * left.square().square();
    const float mass = weight.sum();
    if (round == kShiftRounds || mass == 0.F) return {at, mass};
    at += Vector3f((weight * x).sum(), (weight * y).sum(), (weight * z).sum()) / mass;
  }
}

/// Returns the peaks, most massive first, none of them on another's slope.
std::vector<Peak> find_peaks(const std::vector<Vote>& votes) {
  const VoteSample sample = choose_sample(votes);
  const std::vector<Vector3f> starts = choose_starts(sample);
  std::vector<Peak> climbed(starts.size());
  parallel_for(int(starts.size()), [&](int i) { climbed[i] = climb(sample, starts[i]); });
  std::ranges::stable_sort(climbed, [](const Peak& a, const Peak& b) { return a.mass_m2 > b.mass_m2; });
  std::vector<Peak> peaks;
  for (const Peak& peak : climbed) {
    if (peaks.size() == kMostGroups || peak.mass_m2 < kLeastMass_m2) break;
    bool apart = true;
    float lightest_m2 = 0.F;  // of its neighbours; heavier ones come first
    for (const Peak& other : peaks) {
      const float distance_m = (peak.at - other.at).norm();
      apart = apart && distance_m > kApart_m;
      if (distance_m < kNeighbour_m) lightest_m2 = other.mass_m2;
    }
    if (apart && peak.mass_m2 > kLeastGroupShare * lightest_m2) peaks.push_back(peak);
  }
  return peaks;
}

/// Gives each vote within reach of a peak to the nearest one.
void assign(const std::vector<Peak>& peaks, std::vector<Vote>& votes) {
  for (Vote& vote : votes) {
    float least = kOwn_m * kOwn_m;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
      const float distance = (peaks[i].at - vote.at).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      vote.group = std::uint8_t(i);
    }
  }
}

VoteGroup describe(const Peak& peak, int group, const std::vector<Vote>& votes, const Image<PersonVote>& all) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double body = 0.0, squares = 0.0, cosine = 0.0, sine = 0.0;
  int count = 0;
  for (const Vote& vote : votes) {
    if (vote.group != group) continue;
    ++count;
    sum += vote.at.cast<double>();
    squares += vote.at.cast<double>().squaredNorm();
    body += vote.body;
    cosine += all(vote.column, vote.row).heading[0];
    sine += all(vote.column, vote.row).heading[1];
  }
  const double n = std::max(1, count);
  const double length = std::sqrt(cosine * cosine + sine * sine) / (8192.0 * n);
  return {peak.at,
          count,
          float(std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm()))),
          float(body / n),
          {float(std::atan2(sine, cosine)), float(std::min(1.0, length))}};
}

/// Hands the groups of votes on to the body pixels around them that have no vote of their own, over like depths.
/// Returns whose pixels are; `groups` get the boxes around theirs.
Image<std::uint8_t> spread(const std::vector<Vote>& votes, const Posteriors& posteriors, const DepthImage& depth,
                           int parts, std::vector<VoteGroup>& groups) {
  constexpr std::array<std::array<int, 2>, 4> kSides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  constexpr std::uint8_t kOpen = kBackground - 1;
  Image<std::uint8_t> index(depth.width(), depth.height(), kOpen);
  std::vector<std::array<int, 2>> queue;
  for (const Vote& vote : votes) {
    queue.push_back({vote.column * kVoteStep, vote.row * kVoteStep});
    index(queue.back()[0], queue.back()[1]) = vote.group;
  }
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const auto [u, v] = queue[head];
    const int within_mm = grid_within_mm(depth(u, v));
    for (const auto& [du, dv] : kSides) {
      const int nu = u + du, nv = v + dv;
      if (!index.contains(nu, nv) || index(nu, nv) != kOpen) continue;
      if (std::abs(depth(nu, nv) - depth(u, v)) > within_mm) continue;
      const bool body = is_body(body_share(posteriors, nu, nv, parts));
      index(nu, nv) = body ? index(u, v) : kBackground;
      if (body) queue.push_back({nu, nv});
    }
  }
  std::ranges::replace(index, kOpen, kBackground);
  for (const auto& [u, v] : queue) {
    const std::uint8_t group = index(u, v);
    if (group != kBackground) groups[group].box = around(groups[group].box, {u, v, 1, 1});
  }
  return index;
}

}  // namespace

Vector3f voted_middle(const Image<PersonVote>& votes, const Frame& frame, int column, int row) {
  const std::array<std::int16_t, 3>& way = votes(column, row).middle_mm;
  return point_at(frame.camera, frame.depth, column * kVoteStep, row * kVoteStep) +
         1e-3F * Vector3f(way[0], way[1], way[2]);
}

VoteGroups group_votes(const Posteriors& posteriors, const Frame& frame, int parts) {
  std::vector<Vote> votes = collect_votes(posteriors, frame, parts);
  const std::vector<Peak> peaks = find_peaks(votes);
  assign(peaks, votes);
  VoteGroups groups;
  for (const Peak& peak : peaks)
    groups.items.push_back(describe(peak, int(groups.items.size()), votes, posteriors.votes));
  if (!peaks.empty()) groups.index = spread(votes, posteriors, frame.depth, parts, groups.items);
  return groups;
}

int main_group(const VoteGroups& groups, const Mask& mask) {
  std::vector<long> pixels(groups.items.size(), 0);
  long all = 0;
  for (std::size_t i = 0; i < groups.index.size(); ++i) {
    all += mask[i] != 0 ? 1 : 0;
    if (mask[i] != 0 && groups.index[i] != kBackground) ++pixels[groups.index[i]];
  }
  const auto most = std::ranges::max_element(pixels);
  return most == pixels.end() || 3 * *most <= all ? -1 : int(most - pixels.begin());
}

}  // namespace vesalius
