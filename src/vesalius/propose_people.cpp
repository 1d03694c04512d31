#include "vesalius/propose_people.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/grow_person.h"
#include "vesalius/parallel.h"
#include "vesalius/row_kernels.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {
namespace {

using Candidate = Trace::Candidate;

constexpr float kRivalLikelihood = 0.2F;  // per part: rough skeletons of at least this grow against each other

Box whole(const Mask& mask) { return {0, 0, mask.width(), mask.height()}; }

/// Adds the pixels in a box where the background is sure enough that nobody grows there. Only those `within` a mask
/// matter, unless there is none.
void bar_background(const Posteriors& posteriors, int parts, double least, const Box& box, const Mask* within,
                    Mask& mask) {
  if (least == 0.0) return;
  parallel_ranges(box.height, kRowGrain, [&](int begin, int end) {
    std::vector<BodySums> sums(static_cast<std::size_t>(box.width));
    std::vector<std::uint8_t> skip(sums.size());
    for (int v = box.v + begin; v < box.v + end; ++v) {
      std::uint8_t* barred = mask.row(v) + box.u;
      std::copy_n(barred, box.width, skip.begin());
      if (within != nullptr) {
        const auto or_none = [](std::uint8_t is, std::uint8_t other) { return std::uint8_t(is | (other == 0)); };
        std::transform(skip.begin(), skip.end(), within->row(v) + box.u, skip.begin(), or_none);
      }
      sum_bodies(posteriors, box.u, v, parts, skip.data(), box.width, sums.data());
      for (std::size_t i = 0; i < sums.size(); ++i) {
        const std::optional<double> share = sums[i].share();
        if (share && *share < least) barred[i] = 1;
      }
    }
  });
}

/// Adds the pixels in a box of all groups but `own` (-1: of all) to a mask.
void bar_groups(const VoteGroups& groups, int own, const Box& box, Mask& mask) {
  if (groups.items.empty()) return;
  for (int v = box.v; v < box.v + box.height; ++v) {
    for (int u = box.u; u < box.u + box.width; ++u) {
      if (groups.index(u, v) != kBackground && groups.index(u, v) != own) mask(u, v) = 1;
    }
  }
}

/// Returns those rough skeletons most of whose pixels belong to no group.
std::vector<Skeleton> outside_groups(const Scene& scene) {
  if (scene.groups.items.empty() || scene.rough.empty()) return scene.rough;
  std::vector<int> grouped(scene.clusters.items.size(), 0);
  for (std::size_t i = 0; i < scene.groups.index.size(); ++i) {
    const int cluster = scene.clusters.index[i];
    if (cluster >= 0 && scene.groups.index[i] != kBackground) ++grouped[cluster];
  }
  std::vector<Skeleton> outside = scene.rough;
  std::erase_if(outside, [&](const Skeleton& skeleton) {
    int all = 0, of_groups = 0;
    for (const SkeletonPart& part : skeleton.parts) {
      if (part.cluster < 0) continue;
      all += scene.clusters.items[part.cluster].pixels;
      of_groups += grouped[part.cluster];
    }
    return 2 * of_groups >= all;
  });
  return outside;
}

class Proposer {
 public:
  Proposer(const Frame& frame, const Scene& scene, const Looks& looks, const BodyModel& body,
           const DetectOptions& options)
      : frame_(frame), scene_(scene), looks_(looks), body_(body), options_(options) {}

  std::vector<Candidate> run() const {
    const std::vector<Skeleton> rough = outside_groups(scene_);
    std::vector<Candidate> candidates(limited(scene_.groups.items.size()));
    parallel_for(int(candidates.size()), [&](int i) { candidates[i] = grow_group(i); });
    std::erase_if(candidates, [](const Candidate& c) { return std::ranges::count(c.grown, 1) == 0; });
    if (rough.empty()) return candidates;
    Mask nobody = scene_.labels.flat;
    bar_background(whole(nobody), nullptr, nobody);
    bar_groups(scene_.groups, -1, whole(nobody), nobody);
    std::ranges::move(grow_rough(rough, PersonGrower(frame_, nobody, body_, options_.grow, looks_)),
                      std::back_inserter(candidates));
    return candidates;
  }

 private:
  std::size_t limited(std::size_t count) const {
    return std::min(count, static_cast<std::size_t>(options_.refine.max_candidates));
  }

  void bar_background(const Box& box, const Mask* within, Mask& mask) const {
    vesalius::bar_background(scene_.labels.posteriors(), body_.part_count(), double(options_.grow.least_body), box,
                             within, mask);
  }

  /// Searches a skeleton in the labels of a group and grows it. The group's pixels are the person's anyway.
  Candidate grow_group(int group) const {
    const Image<std::uint8_t>& index = scene_.groups.index;
    const Box& box = scene_.groups.items[group].box;
    Mask inside(index.width(), index.height(), 0), closed = scene_.labels.flat;
    LabelImage labels(index.width(), index.height(), kBackground);
    bar_background(box, nullptr, closed);
    for (int v = box.v; v < box.v + box.height; ++v) {
      for (int u = box.u; u < box.u + box.width; ++u) {
        if (index(u, v) != group) continue;
        labels(u, v) = scene_.proposals(u, v);
        inside(u, v) = closed(u, v) == 0 ? 1 : 0;
      }
    }
    Candidate candidate;
    candidate.group = group;
    candidate.rough.parts.resize(body_.parts.size());
    candidate.grown = std::move(inside);
    const Clusters clusters = find_clusters(labels, frame_.depth, frame_.camera, body_, options_.cluster, box);
    std::vector<Skeleton> found = search_skeletons(clusters.items, body_, options_.search);
    if (found.empty()) return candidate;
    candidate.rough = std::move(found.front());
    const PersonGrower grower(frame_, closed, body_, options_.grow, looks_);
    PersonGrower::Reach reach = grower.reach_of(candidate.rough);
    bar_background(reach.box, &reach.pixels, closed);
    bar_groups(scene_.groups, group, around(reach.box, box), closed);
    const Mask grown = grower.grow(candidate.rough, std::move(reach), clusters, box);
    std::transform(candidate.grown.begin(), candidate.grown.end(), grown.begin(), candidate.grown.begin(),
                   std::bit_or<>());
    return candidate;
  }

  /// Returns how many of the rough skeletons, which come best first, grow against each other.
  std::size_t count_rivals(const std::vector<Skeleton>& rough) const {
    const float least = kRivalLikelihood * float(body_.part_count());
    const auto first_weak = std::ranges::find_if(rough, [&](const Skeleton& s) { return s.score < least; });
    return limited(static_cast<std::size_t>(first_weak - rough.begin()));
  }

  /// Every rough skeleton grows alone; the likelier ones also grow against each other, which separates people who
  /// touch. The second pass decides which result is better.
  std::vector<Candidate> grow_rough(const std::vector<Skeleton>& rough, const PersonGrower& grower) const {
    const std::size_t count = limited(rough.size());
    const std::size_t rivals = count_rivals(rough);
    std::vector<Mask> against;
    if (rivals > 1) {
      against = grower.grow(std::vector<Skeleton>(rough.begin(), rough.begin() + rivals), scene_.clusters);
    }
    std::vector<Mask> alone(count);
    parallel_for(int(count), [&](int i) { alone[i] = std::move(grower.grow({rough[i]}, scene_.clusters)[0]); });
    for (std::size_t i = 0; i < against.size(); ++i) {
      if (alone[i] == against[i]) alone[i] = {};
    }
    std::vector<Candidate> candidates;
    for (std::vector<Mask>* masks : {&against, &alone}) {
      for (std::size_t i = 0; i < masks->size(); ++i) {
        if ((*masks)[i].empty()) continue;
        Candidate& candidate = candidates.emplace_back();
        candidate.rough = rough[i];
        candidate.grown = std::move((*masks)[i]);
      }
    }
    return candidates;
  }

  const Frame& frame_;
  const Scene& scene_;
  const Looks& looks_;
  const BodyModel& body_;
  const DetectOptions& options_;
};

}  // namespace

std::vector<Candidate> propose_people(const Frame& frame, const Scene& scene, const Looks& looks, const BodyModel& body,
                                      const DetectOptions& options) {
  return Proposer(frame, scene, looks, body, options).run();
}

}  // namespace vesalius
