#include "vesalius/grow_person.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vesalius/base/capsule.h"
#include "vesalius/base/rays.h"
#include "vesalius/row_kernels.h"

namespace vesalius {
namespace {

/// Smallest number of pixels from which an appearance is learned.
constexpr int kLeastSamples = 200;
constexpr float kVeto = 2.F;  // a look is refused if it is likelier elsewhere by this, as a log of the ratio

/// Returns the distance to which the body extends around each part. It is larger if a neighbouring part was not seen.
std::vector<float> reach_of_parts(const Skeleton& rough, const BodyModel& body, const GrowOptions& options) {
  std::vector<float> reach(body.parts.size(), options.reach_m);
  for (const BodyLink& link : body.links) {
    const bool has_parent = rough.parts[link.parent].state == State::observed;
    const bool has_child = rough.parts[link.child].state == State::observed;
    if (has_parent == has_child) continue;
    float& r = reach[has_parent ? link.parent : link.child];
    r = std::max(r, options.reach_m + options.missing_reach_m);
  }
  return reach;
}

/// Returns for each part the radius within which a look that the seeds lack may still be the person's: small around
/// any part, and the reach of unseen parts such as hair, hands and shoes.
std::vector<float> any_look_radius(const Skeleton& rough, const BodyModel& body, const GrowOptions& options) {
  std::vector<float> radius(body.parts.size(), options.own_look_m);
  for (const BodyLink& link : body.links) {
    for (const auto& [from, to] : {std::pair{link.parent, link.child}, std::pair{link.child, link.parent}}) {
      if (rough.parts[to].state == State::observed) continue;
      float& r = radius[from];
      r = std::max(r, link.length_m + options.own_look_m);
    }
  }
  return radius;
}

}  // namespace

PersonGrower::PersonGrower(const Frame& frame, const Mask& flat, const BodyModel& body, const GrowOptions& options,
                           const Looks& looks)
    : frame_(frame), flat_(flat), body_(body), options_(options), looks_(looks) {}

PersonGrower::Reach PersonGrower::reach_of(const Skeleton& rough) const {
  return around_parts(rough, reach_of_parts(rough, body_, options_));
}

PersonGrower::Reach PersonGrower::around_parts(const Skeleton& rough, const std::vector<float>& reach) const {
  Reach out{Mask(frame_.depth.width(), frame_.depth.height(), 0), {}};
  for (std::size_t i = 0; i < rough.parts.size(); ++i) {
    if (rough.parts[i].state != State::observed || reach[i] <= 0.F) continue;
    const Eigen::Vector3f& centre = rough.parts[i].centre;
    const Box box = box_around({centre, centre, reach[i], reach[i]}, frame_.camera);
    mark_near(frame_.depth, frame_.camera, centre, reach[i], box, out.pixels);
    out.box = around(out.box, box);
  }
  return out;
}

void PersonGrower::refuse_looks(const Skeleton& rough, const Mask& seeds, const Box& box, AppearanceHistogram person,
                                Mask& allowed) const {
  if (looks_.classes.empty()) return;
  const int width = seeds.width();
  const auto each = [&](const auto& use) {
    for (int v = box.v; v < box.v + box.height; ++v) {
      for (int i = v * width + box.u; i < v * width + box.u + box.width; ++i) use(static_cast<std::size_t>(i));
    }
  };
  AppearanceHistogram rest = looks_.all;
  each([&](std::size_t i) {
    if (seeds[i] != 0) person.add(looks_.classes[i]);
    if (seeds[i] != 0 || (allowed[i] != 0 && flat_[i] == 0)) rest.remove(looks_.classes[i]);
  });
  if (person.samples() < kLeastSamples || rest.samples() < kLeastSamples) return;
  const std::vector<float> here = person.probabilities(*looks_.appearance);
  const std::vector<float> elsewhere = rest.probabilities(*looks_.appearance);
  // Looks that are rare everywhere are as likely elsewhere as if all were equally common.
  const float least = 1.F / float(looks_.appearance->classes());
  std::vector<std::uint8_t> refuses(here.size());
  for (std::size_t look = 0; look < here.size(); ++look) {
    refuses[look] = std::log(std::max(elsewhere[look], least) / here[look]) > kVeto ? 1 : 0;
  }
  const Mask any_look = around_parts(rough, any_look_radius(rough, body_, options_)).pixels;
  each([&](std::size_t i) {
    if (allowed[i] != 0 && seeds[i] == 0 && any_look[i] == 0 && refuses[looks_.classes[i]] != 0) allowed[i] = 0;
  });
}

std::vector<Mask> PersonGrower::grow(const std::vector<Skeleton>& people, const Clusters& clusters,
                                     const std::vector<AppearanceHistogram>& known) const {
  std::vector<Reach> reaches;
  reaches.reserve(people.size());
  for (const Skeleton& person : people) reaches.push_back(reach_of(person));
  return grow(people, std::move(reaches), clusters, known, {0, 0, frame_.depth.width(), frame_.depth.height()});
}

Mask PersonGrower::grow(const Skeleton& person, Reach reach, const Clusters& clusters, const Box& within) const {
  std::vector<Reach> reaches;
  reaches.push_back(std::move(reach));
  return std::move(grow({person}, std::move(reaches), clusters, {}, within)[0]);
}

std::vector<Mask> PersonGrower::grow(const std::vector<Skeleton>& people, std::vector<Reach> reaches,
                                     const Clusters& clusters, const std::vector<AppearanceHistogram>& known,
                                     const Box& within) const {
  const int width = frame_.depth.width();
  const int height = frame_.depth.height();
  Mask nobody(width, height, 0);
  std::vector<Mask> grown(people.size(), nobody);
  std::vector<int> owner_of(clusters.items.size(), -1);
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (const SkeletonPart& part : people[i].parts) {
      if (part.cluster >= 0) owner_of[part.cluster] = int(i);
    }
  }
  struct Front {
    int u, v;
    int person;
  };
  std::vector<Front> queue;
  Mask taken = flat_;
  for (int v = within.v; v < within.v + within.height; ++v) {
    for (int u = within.u; u < within.u + within.width; ++u) {
      const std::int32_t cluster = clusters.index(u, v);
      const int owner = cluster < 0 ? -1 : owner_of[cluster];
      if (owner < 0 || taken(u, v) != 0) continue;
      taken(u, v) = 1;
      grown[owner](u, v) = 1;
      queue.push_back({u, v, owner});
    }
  }
  for (std::size_t i = 0; i < people.size(); ++i) {
    refuse_looks(people[i], grown[i], around(within, reaches[i].box), known.empty() ? AppearanceHistogram{} : known[i],
                 reaches[i].pixels);
  }
  const Rays rays(frame_.camera);
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const auto [u, v, person] = queue[head];
    const Eigen::Vector3f here = rays.point(frame_.depth, u, v);
    const float radius = options_.radius_m + options_.radius_per_z2 * here.z() * here.z();
    for (int nv = std::max(0, v - 1); nv <= std::min(height - 1, v + 1); ++nv) {
      for (int nu = std::max(0, u - 1); nu <= std::min(width - 1, u + 1); ++nu) {
        if (taken(nu, nv) != 0 || reaches[person].pixels(nu, nv) == 0) continue;
        if ((rays.point(frame_.depth, nu, nv) - here).squaredNorm() > radius * radius) continue;
        taken(nu, nv) = 1;
        grown[person](nu, nv) = 1;
        queue.push_back({nu, nv, person});
      }
    }
  }
  return grown;
}

}  // namespace vesalius
