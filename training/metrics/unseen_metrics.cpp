#include "metrics/unseen_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "vesalius/explain_unseen.h"

namespace vesalius {
namespace {

constexpr float kOwnFlesh_m = 0.15F;  // from a joint to the skin, at most
constexpr float kInFront_m = 0.05F;

/// The reasons of the table, in its order. The own body is told apart from others'.
constexpr std::array kReasonNames{"out_of_picture",   "behind_other", "behind_itself",
                                  "behind_something", "no_depth",     "not_sure"};

int place_of_reason(Unseen unseen, bool itself) {
  switch (unseen) {
    case Unseen::out_of_picture:
      return 0;
    case Unseen::behind_person:
      return itself ? 2 : 1;
    case Unseen::behind_something:
      return 3;
    case Unseen::no_depth:
      return 4;
    default:
      return 5;
  }
}

/// Returns what one pixel tells.
TrueReason reason_at(const TrueFrame& frame, std::size_t person, const TrueJoint& joint, int u, int v) {
  const float depth_m = float(frame.frame.depth(u, v)) * 1e-3F;
  if (depth_m == 0.F) return {Unseen::no_depth, -1};
  const std::uint8_t who = frame.truth.person(u, v);
  const bool itself = who == person;
  if (depth_m >= joint.at.z() - (itself ? kOwnFlesh_m : kInFront_m)) return {};
  if (itself && !frame.truth.labels.empty() &&
      std::ranges::find(joint.parts, int(frame.truth.labels(u, v))) != joint.parts.end())
    return {};
  return who == kBackground ? TrueReason{Unseen::behind_something, -1} : TrueReason{Unseen::behind_person, int(who)};
}

}  // namespace

TrueReason true_reason(const TrueFrame& frame, std::size_t person, const TrueJoint& joint) {
  const DepthImage& depth = frame.frame.depth;
  if (!(joint.at.z() > 0.F)) return {Unseen::out_of_picture, -1};
  const Eigen::Vector2f pixel = frame.frame.camera.pixel(joint.at);
  const Box picture = picture_with_readings(depth);
  const auto inside = [](float x, int from, int size) {
    return x >= float(from) - 0.5F && x < float(from + size) - 0.5F;
  };
  if (!inside(pixel.x(), picture.u, picture.width) || !inside(pixel.y(), picture.v, picture.height)) {
    return {Unseen::out_of_picture, -1};
  }
  // What most of the nine pixels about it tell: a reading that is missing alone hides nothing.
  std::map<std::pair<Unseen, int>, int> votes;
  const auto u = int(std::lround(pixel.x())), v = int(std::lround(pixel.y()));
  for (int y = v - 1; y <= v + 1; ++y) {
    for (int x = u - 1; x <= u + 1; ++x) {
      if (!depth.contains(x, y)) continue;
      const TrueReason reason = reason_at(frame, person, joint, x, y);
      ++votes[{reason.unseen, reason.behind}];
    }
  }
  const auto most = std::ranges::max_element(votes, {}, [](const auto& vote) { return vote.second; });
  return {most->first.first, most->first.second};
}

MetricTerms unseen_terms(const TrueFrame& frame, std::size_t person, const std::vector<std::string>& names,
                         const std::vector<Eigen::Vector3f>& truth, const JointSet& set,
                         const std::vector<Joint>& joints, const std::vector<int>& found) {
  MetricTerms terms;
  if (frame.truth.person.empty() || joints.empty()) return terms;
  const int own = found[person];
  for (std::size_t j = 0; j < names.size(); ++j) {
    const auto named = std::ranges::find(set.joints, names[j], &JointDefinition::name);
    const Joint& joint = joints[static_cast<std::size_t>(named - set.joints.begin())];
    if (joint.state == State::observed || !truth[j].allFinite()) continue;
    const TrueReason reason = true_reason(frame, person, {truth[j], named->parts});
    const bool hidden_by_other = reason.unseen == Unseen::behind_person && reason.behind != int(person);
    const int real = place_of_reason(reason.unseen, !hidden_by_other);
    const int given = place_of_reason(joint.unseen, joint.behind == own);
    const auto hider = static_cast<std::size_t>(reason.behind);
    const bool right = real == given && (!hidden_by_other || (hider < found.size() && found[hider] == joint.behind));
    terms.push_back({Metric::unseen_right, right ? 1.0 : 0.0, 1.0});
    const int tenth = std::clamp(int(10.F * joint.confidence), 0, 9);
    terms.push_back({{Metric::unseen_right_confidence, tenth, fmt::format("{}_to_{}", 10 * tenth, 10 * tenth + 10)},
                     right ? 1.0 : 0.0,
                     1.0});
    for (int as = 0; as < int(kReasonNames.size()); ++as) {
      terms.push_back({{Metric::unseen_given, int(kReasonNames.size()) * real + as,
                        fmt::format("{}_as_{}", kReasonNames[real], kReasonNames[as])},
                       as == given ? 1.0 : 0.0,
                       1.0});
    }
  }
  return terms;
}

}  // namespace vesalius
