#include "vesalius/known_people.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/rays.h"
#include "vesalius/parallel.h"
#include "vesalius/row_kernels.h"

namespace vesalius {
namespace {

constexpr std::uint8_t kNobody = 255;
constexpr std::uint8_t kSure = 2;     // in a mask: a pixel that the person is given even where nothing grew over it
constexpr float kSureLogOdds = 1.4F;  // from which a pixel is sure
constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kNear_m = 0.04F;     // up to here a pixel lies on the flesh
constexpr float kMostLogOdds = 2.F;  // of a pixel on the flesh
constexpr float kEven_m = 0.16F;     // where flesh says nothing either way
constexpr double kSureBody = 0.5;    // posterior of pixels that somebody keeps who is not near

/// Returns the logarithm of the odds that a pixel at this distance from a person's flesh is the person's: 0 almost at
/// the reach.
float flesh_log_odds(float distance_m) {
  return kMostLogOdds * (1.F - std::max(0.F, distance_m - kNear_m) / (kEven_m - kNear_m));
}

float log_odds(double share) {
  const auto least = std::clamp(float(share), 1e-4F, 1.F - 1e-4F);
  return std::log(least / (1.F - least));
}

}  // namespace

namespace {

/// A capsule, and where a pixel must lie to be within reach of it.
struct Reach {
  Capsule capsule;
  float nearest_m = 0.F, farthest_m = 0.F;
  Box box;
};

std::vector<Reach> reaches_of(const std::vector<Capsule>& capsules, const Camera& camera, float reach_m) {
  std::vector<Reach> all;
  for (const Capsule& capsule : capsules) {
    if (!capsule.from.allFinite() || !capsule.to.allFinite()) continue;
    const float reach = reach_m + std::max(capsule.from_radius, capsule.to_radius);
    const float nearest = std::min(capsule.from.z(), capsule.to.z()) - reach;
    const float farthest = std::max(capsule.from.z(), capsule.to.z()) + reach;
    if (farthest <= 0.F) continue;
    const Capsule wider{capsule.from, capsule.to, capsule.from_radius + reach_m, capsule.to_radius + reach_m};
    all.push_back({capsule, nearest, farthest, box_around(wider, camera)});
  }
  return all;
}

}  // namespace

Image<float> distance_from(const std::vector<Capsule>& capsules, const Frame& frame, float reach_m) {
  Image<float> distance(frame.depth.width(), frame.depth.height(), kFar);
  const std::vector<Reach> reaches = reaches_of(capsules, frame.camera, reach_m);
  Box all;
  for (const Reach& one : reaches) all = around(all, one.box);
  const Rays rays(frame.camera);
  parallel_ranges(all.height, kRowGrain, [&](int begin, int end) {
    const auto width = static_cast<std::size_t>(frame.depth.width());
    PointRow points{std::vector<float>(width), std::vector<float>(width), std::vector<float>(width)};
    for (int v = all.v + begin; v < all.v + end; ++v) {
      for (int u = all.u; u < all.u + all.width; ++u) {
        const Eigen::Vector3f point = rays.point(frame.depth, u, v);
        points.x[u] = point.x();
        points.y[u] = point.y();
        points.z[u] = point.z();
      }
      for (const auto& [capsule, nearest_m, farthest_m, box] : reaches) {
        if (v < box.v || v >= box.v + box.height) continue;
        lower_distances(points, static_cast<std::size_t>(box.u), static_cast<std::size_t>(box.u + box.width), capsule,
                        nearest_m, farthest_m, reach_m, distance.row(v));
      }
    }
  });
  return distance;
}

KnownPeople::KnownPeople(const Frame& frame, const Mask& flat, const Posteriors& posteriors, int parts, Prior& prior)
    : prior_(prior), posteriors_(posteriors), parts_(parts) {
  std::vector<Image<float>> distance(prior.people.size());
  parallel_for(int(prior.people.size()), [&](int i) {
    if (!prior.people[i].flesh.empty()) distance[i] = distance_from(prior.people[i].flesh, frame, kFleshReach_m);
  });
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (distance[i].empty()) continue;
    if (owner_.empty()) owner_ = Image<std::uint8_t>(frame.depth.width(), frame.depth.height(), kNobody);
    prior.people[i].mask = Mask(frame.depth.width(), frame.depth.height(), 0);
  }
  for (std::size_t pixel = 0; pixel < owner_.size(); ++pixel) {
    if (flat[pixel] == 0) give(pixel, distance, prior);
  }
}

void KnownPeople::give(std::size_t pixel, const std::vector<Image<float>>& distance, Prior& prior) {
  int nearest = -1, nearest_sure = -1;
  const auto away = [&](int person) { return person < 0 ? kFar : distance[static_cast<std::size_t>(person)][pixel]; };
  for (int i = 0; i < int(distance.size()); ++i) {
    if (distance[static_cast<std::size_t>(i)].empty()) continue;
    if (away(i) < away(nearest)) nearest = i;
    if (prior.people[static_cast<std::size_t>(i)].odds > 1.F && away(i) < away(nearest_sure)) nearest_sure = i;
  }
  if (nearest < 0) return;
  const int u = int(pixel) % owner_.width(), v = int(pixel) / owner_.width();
  const float body = log_odds(body_share(posteriors_, u, v, parts_).value_or(0.5));
  const auto likely = [&](int person) { return person >= 0 ? body + flesh_log_odds(away(person)) : -kFar; };
  // A guess takes nothing from people who are sure.
  const int whose = likely(nearest_sure) > 0.F ? nearest_sure : nearest;
  if (likely(whose) <= 0.F) return;
  if (whose == nearest_sure) owner_[pixel] = static_cast<std::uint8_t>(whose);
  prior.people[static_cast<std::size_t>(whose)].mask[pixel] = likely(whose) > kSureLogOdds ? kSure : 1;
}

int KnownPeople::shown_by(const Mask& mask) const {
  int best = -1;
  float most = kKnownOverlap;
  for (std::size_t i = 0; i < prior_.people.size(); ++i) {
    const Mask& known = prior_.people[i].mask;
    const float share = known.empty() ? 0.F : shared_pixels(mask, known);
    if (share < most) continue;
    most = share;
    best = int(i);
  }
  return best;
}

void KnownPeople::correct(int owner, bool at_flesh, Mask& mask) const {
  if (owner_.empty()) return;
  const Prior::KnownPerson* known = owner < 0 ? nullptr : &prior_.people[static_cast<std::size_t>(owner)];
  if (known != nullptr && known->flesh.empty()) known = nullptr;
  for (int v = 0; v < mask.height(); ++v) {
    for (int u = 0; u < mask.width(); ++u) {
      if (known != nullptr && known->mask(u, v) == kSure) mask(u, v) = 1;
      if (mask(u, v) == 0) continue;
      const bool of_another = owner_(u, v) != kNobody && owner_(u, v) != owner;
      const bool far_off = at_flesh && known != nullptr && known->mask(u, v) == 0;
      if (of_another || (far_off && body_share(posteriors_, u, v, parts_).value_or(1.0) < kSureBody)) mask(u, v) = 0;
    }
  }
}

}  // namespace vesalius
