#include "vesalius/group_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr int kStarts = 300;
constexpr float kSameStart_m = 0.05F;  // starts this near climb to the same peak
constexpr int kRounds = 4;
constexpr float kReach_m = 0.3F;  // of the kernel, which is much like a Gaussian of 10 cm
constexpr float kLeastMass_m2 = 0.004F;
constexpr float kApart_m = 0.3F;  // least distance of two peaks
constexpr float kNeighbour_m = 1.F;
constexpr float kLeastShare = 0.15F;             // least mass of a peak as a share of its lightest neighbour's
constexpr float kOwn_m = 0.6F;                   // most distance of a vote from its peak
constexpr std::uint8_t kOpen = kBackground - 1;  // pixels without a vote at their depth around them

/// A pixel that votes.
struct Vote {
  int column = 0, row = 0;  ///< of the picture of votes
  Vector3f at = Vector3f::Zero();
  float area_m2 = 0.F;  ///< surface for which it stands
  double body = 0.0;
};

struct Peak {
  Vector3f at = Vector3f::Zero();
  float mass_m2 = 0.F;
};

std::vector<Vote> collect_votes(const Posteriors& posteriors, const Frame& frame, int parts) {
  std::vector<Vote> votes;
  for (int row = 0; row < posteriors.votes.height(); ++row) {
    for (int column = 0; column < posteriors.votes.width(); ++column) {
      const int u = column * kVoteStep, v = row * kVoteStep;
      if (frame.depth(u, v) == 0) continue;
      const std::optional<double> body = body_share(posteriors, u, v, parts);
      if (!body || *body <= 0.5) continue;
      const float side_m = float(frame.depth(u, v)) * 1e-3F * float(kVoteStep);
      votes.push_back({column, row, voted_middle(posteriors.votes, frame, column, row),
                       side_m * side_m / (frame.camera.fx * frame.camera.fy), *body});
    }
  }
  return votes;
}

/// Returns votes from which to climb: spread evenly over the surface that votes, so that far people have theirs, and
/// apart from each other.
std::vector<Vector3f> choose_starts(const std::vector<Vote>& votes) {
  double all = 0.0;
  for (const Vote& vote : votes) all += double(vote.area_m2);
  const double step = all / kStarts;
  std::vector<Vector3f> starts;
  double passed = 0.0, next = 0.5 * step;
  for (const Vote& vote : votes) {
    passed += double(vote.area_m2);
    if (passed < next) continue;
    while (next <= passed) next += step;
    const auto near = [&](const Vector3f& start) {
      return (start - vote.at).squaredNorm() < kSameStart_m * kSameStart_m;
    };
    if (std::ranges::none_of(starts, near)) starts.push_back(vote.at);
  }
  return starts;
}

/// Returns where the densest votes near `at` are. The kernel is a polynomial, the same on all processors.
Peak climb(const std::vector<Vote>& votes, Vector3f at) {
  constexpr float kSquare = 1.F / (kReach_m * kReach_m);
  for (int round = 0;; ++round) {
    float mass = 0.F;
    Vector3f sum = Vector3f::Zero();
    for (const Vote& vote : votes) {
      const Vector3f off = vote.at - at;
      const float left = 1.F - kSquare * off.squaredNorm();
      if (left <= 0.F) continue;
      const float weight = vote.area_m2 * (left * left) * (left * left);
      mass += weight;
      sum += weight * off;
    }
    if (round == kRounds || mass == 0.F) return {at, mass};
    at += sum / mass;
  }
}

/// Returns the peaks, most massive first, none of them on another's slope.
std::vector<Peak> find_peaks(const std::vector<Vote>& votes) {
  const std::vector<Vector3f> starts = choose_starts(votes);
  std::vector<Peak> climbed(starts.size());
  parallel_for(int(starts.size()), [&](int i) { climbed[i] = climb(votes, starts[i]); });
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
    if (apart && peak.mass_m2 > kLeastShare * lightest_m2) peaks.push_back(peak);
  }
  return peaks;
}

/// Returns the index of the nearest peak within reach of a vote, or -1.
int nearest_peak(const std::vector<Peak>& peaks, const Vector3f& at) {
  int nearest = -1;
  float least = kOwn_m * kOwn_m;
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    const float distance = (peaks[i].at - at).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = int(i);
  }
  return nearest;
}

VoteGroup describe(const Vector3f& middle, const std::vector<const Vote*>& votes, const Image<PersonVote>& all) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area_m2 = 0.0, body = 0.0, squares = 0.0;
  std::array<std::int64_t, 2> heading{};
  for (const Vote* vote : votes) {
    sum += vote->at.cast<double>();
    area_m2 += double(vote->area_m2);
    body += vote->body;
    const PersonVote& of = all(vote->column, vote->row);
    for (std::size_t i = 0; i < heading.size(); ++i) heading[i] += of.heading[i];
  }
  const auto count = double(votes.size());
  for (const Vote* vote : votes) squares += (vote->at.cast<double>() - sum / count).squaredNorm();
  const double cosine = double(heading[0]), sine = double(heading[1]);
  const double length = std::sqrt(cosine * cosine + sine * sine) / (8192.0 * count);
  return {middle,
          int(votes.size()),
          float(area_m2),
          float(std::sqrt(squares / count)),
          float(body / count),
          {float(std::atan2(sine, cosine)), float(std::min(1.0, length))}};
}

/// Gives every pixel the group of that vote around it which is nearest in depth, and kOpen where none is at its depth.
Image<std::uint8_t> of_pixels(const std::vector<Vote>& votes, const Image<std::uint8_t>& of_vote,
                              const DepthImage& depth) {
  Mask voting(of_vote.width(), of_vote.height(), 0);
  for (const Vote& vote : votes) voting(vote.column, vote.row) = 1;
  DepthImage asked = depth;
  for (int row = 0; row < voting.height(); ++row) {
    for (int column = 0; column < voting.width(); ++column) {
      if (voting(column, row) == 0) asked(column * kVoteStep, row * kVoteStep) = 0;
    }
  }
  return GridGuide(asked, kVoteStep).enlarge(of_vote, kOpen, bounding_box(voting));
}

/// Hands each group on to the body pixels beside its own that have no vote around them, such as thin limbs.
void spread(const Posteriors& posteriors, const DepthImage& depth, int parts, Image<std::uint8_t>& index) {
  constexpr std::array<std::array<int, 2>, 4> kSides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  const auto is_body = [&](int u, int v) { return body_share(posteriors, u, v, parts).value_or(0.0) > 0.5; };
  std::vector<int> queue;
  for (int v = 0; v < index.height(); ++v) {
    for (int u = 0; u < index.width(); ++u) {
      if (index(u, v) >= kOpen) continue;
      if (is_body(u, v)) {
        queue.push_back(v * index.width() + u);
      } else {
        index(u, v) = kBackground;
      }
    }
  }
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const int u = queue[head] % index.width(), v = queue[head] / index.width();
    for (const auto& [du, dv] : kSides) {
      const int nu = u + du, nv = v + dv;
      if (!index.contains(nu, nv) || index(nu, nv) != kOpen) continue;
      if (std::abs(depth(nu, nv) - depth(u, v)) > grid_within_mm(depth(u, v))) continue;
      index(nu, nv) = is_body(nu, nv) ? index(u, v) : kBackground;
      if (index(nu, nv) != kBackground) queue.push_back(nv * index.width() + nu);
    }
  }
  std::ranges::replace(index, kOpen, kBackground);
}

}  // namespace

Vector3f voted_middle(const Image<PersonVote>& votes, const Frame& frame, int column, int row) {
  const std::array<std::int16_t, 3>& way = votes(column, row).middle_mm;
  return point_at(frame.camera, frame.depth, column * kVoteStep, row * kVoteStep) +
         1e-3F * Vector3f(way[0], way[1], way[2]);
}

VoteGroups group_votes(const Posteriors& posteriors, const Frame& frame, int parts) {
  const std::vector<Vote> votes = collect_votes(posteriors, frame, parts);
  std::vector<Peak> peaks = find_peaks(votes);
  std::vector<std::vector<const Vote*>> of_peak(peaks.size());
  for (const Vote& vote : votes) {
    const int peak = nearest_peak(peaks, vote.at);
    if (peak >= 0) of_peak[peak].push_back(&vote);
  }
  VoteGroups groups;
  Image<std::uint8_t> of_vote(posteriors.votes.width(), posteriors.votes.height(), kBackground);
  for (std::size_t p = 0; p < peaks.size(); ++p) {
    if (of_peak[p].empty()) continue;
    for (const Vote* vote : of_peak[p]) of_vote(vote->column, vote->row) = std::uint8_t(groups.items.size());
    groups.items.push_back(describe(peaks[p].at, of_peak[p], posteriors.votes));
  }
  if (groups.items.empty()) return groups;
  groups.index = of_pixels(votes, of_vote, frame.depth);
  spread(posteriors, frame.depth, parts, groups.index);
  return groups;
}

int main_group(const VoteGroups& groups, const Mask& mask) {
  std::vector<long> pixels(groups.items.size(), 0);
  for (std::size_t i = 0; i < groups.index.size(); ++i) {
    if (mask[i] != 0 && groups.index[i] != kBackground) ++pixels[groups.index[i]];
  }
  const auto most = std::ranges::max_element(pixels);
  return most == pixels.end() || *most == 0 ? -1 : int(most - pixels.begin());
}

}  // namespace vesalius
