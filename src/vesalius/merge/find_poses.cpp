#include "vesalius/merge/find_poses.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "vesalius/error.h"
#include "vesalius/merge/joint_spread.h"
#include "vesalius/merge/rigid_fit.h"

namespace vesalius {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kMoment_s = 0.199;          // a fifth of a second, however times are rounded
constexpr std::size_t kMostMoments = 3000;   // ten minutes
constexpr int kLeastMoments = 15;            // three seconds
constexpr std::size_t kFittedMoments = 200;  // of two people that may be one
constexpr float kSureJoint = 0.4F;           // confidence of joints that count
constexpr std::size_t kLeastJoints = 4;
constexpr double kSame_m = 0.25;     // root of the mean square distance of joints of one person, at most
constexpr double kRival = 0.7;       // share of the best one's support that another way to be the same has at most
constexpr double kOtherTurn = 0.35;  // radians, and metres, beyond which it is another
constexpr double kOtherPlace_m = 0.5;

bool is_other(const Isometry3d& a, const Isometry3d& b) {
  return (a.translation() - b.translation()).norm() > kOtherPlace_m ||
         Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() > kOtherTurn;
}

}  // namespace

/// Two cameras and what ties them.
class PoseFinder::Pair {
 public:
  Pair(const PoseFinder& all, std::size_t to, std::size_t from) : all_(all), to_(to), from_(from) {
    const Floor &a = all.floors_[to], &b = all.floors_[from];
    if (a.seen == 0 || b.seen == 0) return;
    floor_ = {a.up.normalized(), b.up.normalized(), a.height_m / a.seen, b.height_m / b.seen};
  }

  struct Fit {
    Isometry3d to_from = Isometry3d::Identity();
    double support = 0.0;
    double residual_m = 0.0;
    int moments = 0;
  };

  std::optional<Fit> find() const {
    std::vector<Fit> fits;
    for (const auto& [ids, pairs] : possible()) {
      const std::optional<Isometry3d> first = rigid_fit(pairs);
      if (first) fits.push_back(judge(rigid_refine(*first, pairs, floor_)));
    }
    if (fits.empty()) return std::nullopt;
    Fit best = *std::ranges::max_element(fits, {}, &Fit::support);
    constexpr int kRounds = 3;
    for (int i = 0; i < kRounds; ++i) {
      const std::vector<PointPair> pairs = same(best.to_from).pairs;
      if (pairs.size() < kLeastJoints) return std::nullopt;
      best = judge(rigid_refine(best.to_from, pairs, floor_));
    }
    const bool has_rival = std::ranges::any_of(fits, [&](const Fit& fit) {
      return fit.support > kRival * best.support && is_other(fit.to_from, best.to_from);
    });
    if (has_rival || best.moments < kLeastMoments) return std::nullopt;
    return best;
  }

 private:
  struct Same {
    std::vector<PointPair> pairs;
    double support = 0.0;
    int moments = 0;
  };

  static std::vector<PointPair> joint_pairs(const Sighted& a, const Sighted& b) {
    std::vector<PointPair> pairs;
    for (std::size_t j = 0; j < std::min(a.joints.size(), b.joints.size()); ++j) {
      const JointPlace &to = a.joints[j], &from = b.joints[j];
      if (to.variance_m2 > 0.0 && from.variance_m2 > 0.0) {
        pairs.push_back({to.at, from.at, to.variance_m2 + from.variance_m2 + double(kJointBias_m * kJointBias_m)});
      }
    }
    return pairs;
  }

  /// Returns the joints of all two people who may be one: of ids that were seen together for long enough.
  std::map<std::pair<int, int>, std::vector<PointPair>> possible() const {
    std::map<std::pair<int, int>, std::vector<std::vector<PointPair>>> moments;
    for (const Moment& moment : all_.moments_) {
      for (const Sighted& a : moment.people[to_]) {
        for (const Sighted& b : moment.people[from_]) {
          std::vector<PointPair> pairs = joint_pairs(a, b);
          if (pairs.size() >= kLeastJoints) moments[{a.id, b.id}].push_back(std::move(pairs));
        }
      }
    }
    std::map<std::pair<int, int>, std::vector<PointPair>> possible;
    for (const auto& [ids, seen] : moments) {
      if (int(seen.size()) < kLeastMoments) continue;
      const std::size_t step = (seen.size() + kFittedMoments - 1) / kFittedMoments;
      for (std::size_t m = 0; m < seen.size(); m += step) {
        possible[ids].insert(possible[ids].end(), seen[m].begin(), seen[m].end());
      }
    }
    return possible;
  }

  /// Returns who is the same at a moment, the nearest first, and how well.
  void add_same(const Moment& moment, const Isometry3d& to_from, Same& same) const {
    struct Match {
      double distance_m;
      std::size_t a, b;
      std::vector<PointPair> pairs;
    };
    std::vector<Match> matches;
    for (std::size_t a = 0; a < moment.people[to_].size(); ++a) {
      for (std::size_t b = 0; b < moment.people[from_].size(); ++b) {
        std::vector<PointPair> pairs = joint_pairs(moment.people[to_][a], moment.people[from_][b]);
        if (pairs.size() < kLeastJoints) continue;
        double sum = 0.0;
        for (const PointPair& pair : pairs) sum += (to_from * pair.from - pair.to).squaredNorm();
        const double distance_m = std::sqrt(sum / double(pairs.size()));
        if (distance_m < kSame_m) matches.push_back({distance_m, a, b, std::move(pairs)});
      }
    }
    std::ranges::stable_sort(matches, {}, &Match::distance_m);
    std::vector<bool> taken_a(moment.people[to_].size()), taken_b(moment.people[from_].size());
    bool any = false;
    for (const Match& match : matches) {
      if (taken_a[match.a] || taken_b[match.b]) continue;
      taken_a[match.a] = taken_b[match.b] = any = true;
      same.support += 1.0 - match.distance_m * match.distance_m / (kSame_m * kSame_m);
      same.pairs.insert(same.pairs.end(), match.pairs.begin(), match.pairs.end());
    }
    same.moments += any ? 1 : 0;
  }

  Same same(const Isometry3d& to_from) const {
    Same same;
    for (const Moment& moment : all_.moments_) add_same(moment, to_from, same);
    return same;
  }

  Fit judge(const Isometry3d& to_from) const {
    const Same people = same(to_from);
    Fit fit{to_from, people.support, 0.0, people.moments};
    std::vector<double> distances;
    for (const PointPair& pair : people.pairs) distances.push_back((to_from * pair.from - pair.to).norm());
    if (distances.empty()) return fit;
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    fit.residual_m = *middle;
    return fit;
  }

  const PoseFinder& all_;
  std::size_t to_, from_;
  std::optional<FloorPair> floor_;
};

PoseFinder::PoseFinder(std::size_t cameras) : cameras_(cameras), floors_(cameras) {}

bool PoseFinder::is_full() const { return moments_.size() >= kMostMoments; }

void PoseFinder::add(double time_s, const std::vector<TrackedFrame>& seen) {
  if (seen.size() != cameras_) throw Error("poses: people of another number of cameras than there are");
  if (is_full() || (!moments_.empty() && std::abs(time_s - last_s_) < kMoment_s)) return;
  last_s_ = time_s;
  Moment& moment = moments_.emplace_back();
  moment.people.resize(cameras_);
  int cameras_with_people = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (const auto& floor = seen[c].floor) {
      floors_[c].up += floor->up.cast<double>();
      floors_[c].height_m += double(floor->height_m);
      ++floors_[c].seen;
    }
    for (const TrackedPerson& person : seen[c].people) {
      if (person.state != TrackState::tracked || person.person.joints.empty()) continue;
      Sighted& sighted = moment.people[c].emplace_back();
      sighted.id = person.id;
      for (const Joint& joint : person.person.joints.front()) {
        const Vector3d at = joint.position.cast<double>();
        JointPlace place{at - kJointsBehind_m * at.normalized()};
        const auto sigma = double(sigma_of(joint.confidence));
        if (joint.state != State::none && joint.confidence >= kSureJoint) place.variance_m2 = sigma * sigma;
        sighted.joints.push_back(place);
      }
    }
    cameras_with_people += moment.people[c].empty() ? 0 : 1;
  }
  shared_ += cameras_with_people > 1 ? 1 : 0;
}

std::optional<std::vector<FoundPose>> PoseFinder::find() const {
  std::map<std::pair<std::size_t, std::size_t>, std::optional<Pair::Fit>> ties;
  for (std::size_t a = 0; a < cameras_; ++a) {
    for (std::size_t b = a + 1; b < cameras_; ++b) ties[{a, b}] = Pair(*this, a, b).find();
  }
  std::vector<FoundPose> poses(cameras_);
  std::vector<bool> known(cameras_, false);
  known[0] = true;
  for (std::size_t n = 1; n < cameras_; ++n) {
    const Pair::Fit* best = nullptr;
    std::size_t to = 0, from = 0;
    for (const auto& [cameras, fit] : ties) {
      if (!fit || known[cameras.first] == known[cameras.second]) continue;
      if (best != nullptr && fit->support <= best->support) continue;
      best = &*fit;
      std::tie(to, from) = cameras;
    }
    if (best == nullptr) return std::nullopt;
    Isometry3d tie = best->to_from;
    if (known[from]) {
      std::swap(to, from);
      tie = tie.inverse();
    }
    poses[from] = {poses[to].first_from_this * tie.cast<float>(), float(best->residual_m), int(to), best->moments};
    known[from] = true;
  }
  return poses;
}

}  // namespace vesalius
