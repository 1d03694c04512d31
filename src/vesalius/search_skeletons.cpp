#include "vesalius/search_skeletons.h"

#include <algorithm>
#include <cmath>

namespace vesalius {
namespace {

/// Share of a part's typical area above which its visible area costs no likelihood.
constexpr float kLeastAreaShare = 0.25F;
constexpr float kSizeTolerance = 0.7F;  // deviation of log(area) from the feasible range that halves a part's gain
constexpr float kMostAreaShare = 2.5F;

/// The kinematic tree as seen from one root; links are followed away from it.
struct RootedTree {
  int root = -1;
  std::vector<std::vector<int>> children;  ///< [part]
  std::vector<int> order;                  ///< parents before children
};

RootedTree root_tree(const BodyModel& body, int root) {
  RootedTree tree{root, std::vector<std::vector<int>>(body.parts.size()), {root}};
  std::vector<int> parent(body.parts.size(), -1);
  for (std::size_t head = 0; head < tree.order.size(); ++head) {
    const int at = tree.order[head];
    for (const BodyLink& link : body.links) {
      const int next = link.parent == at ? link.child : link.child == at ? link.parent : -1;
      if (next < 0 || next == parent[at]) continue;
      parent[next] = at;
      tree.children[at].push_back(next);
      tree.order.push_back(next);
    }
  }
  return tree;
}

/// The range of distances of the centres of two parts.
struct Span {
  float low_m = 0.F;
  float high_m = 0.F;
  float tolerance_m = 1.F;
  float hidden_m = 0.F;  ///< length of an unseen part between them
};

/// `size` multiplies lengths. Tolerances stay: people of all sizes deviate by as much.
Span span_of(const BodyLink& link, float size) {
  return {size * link.length_m, size * link.length_m, link.tolerance_m, 0.F};
}

/// Returns the range for two consecutive links, from half folded to stretched out.
Span span_of(const BodyLink& a, const BodyLink& b, float size) {
  const float most = size * (a.length_m + b.length_m);
  const float least = std::max(size * std::abs(a.length_m - b.length_m), 0.5F * most);
  return {least, most, std::max(a.tolerance_m, b.tolerance_m), 0.5F * most};
}

/// Returns d_n of section 6 in tolerances: the deviation of the distance between two clusters from that of their parts,
/// and the empty space between their extents.
float normalised_distance(const PartCluster& a, const PartCluster& b, const Span& span, const SearchOptions& options) {
  const Eigen::Vector3f line = b.centroid - a.centroid;
  const float distance = line.norm();
  const Eigen::Vector3f n = distance > 1e-6F ? Eigen::Vector3f(line / distance) : Eigen::Vector3f(0.F, 0.F, 1.F);
  const float var_a = std::max(0.F, n.dot(a.covariance * n));
  const float var_b = std::max(0.F, n.dot(b.covariance * n));
  const float outside = std::max({0.F, span.low_m - distance, distance - span.high_m});
  const float tolerance = std::sqrt(span.tolerance_m * span.tolerance_m + options.covariance_share * (var_a + var_b));
  // Half the length of a uniform rod is sqrt(3) standard deviations.
  const float gap = std::max(0.F, distance - std::sqrt(3.F) * (std::sqrt(var_a) + std::sqrt(var_b)) - span.hidden_m);
  return std::hypot(outside / tolerance, gap / options.gap_tolerance_m);
}

/// A cluster that is consistent with another one, and its error.
struct Partner {
  int cluster = -1;
  float error = 0.F;
};

/// The chosen continuation from a cluster to one child part: the child itself, or grandchildren past a missing child.
struct Branch {
  float value = 0.F;
  std::vector<Partner> partners;
};

class SkeletonSearch {
 public:
  SkeletonSearch(const std::vector<PartCluster>& clusters, const BodyModel& body, const SearchOptions& options,
                 float size)
      : clusters_(clusters),
        body_(body),
        options_(options),
        size_(size),
        used_(clusters.size(), false),
        by_part_(body.parts.size()) {
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      by_part_[clusters[i].label].push_back(int(i));
      gains_.push_back(gain(clusters[i]));
    }
    for (const int root : body.roots) trees_.push_back(root_tree(body, root));
    for (int part = 0; options.any_root && part < body.part_count(); ++part) {
      const bool proposed = !by_part_[part].empty();
      if (proposed && std::ranges::find(body.roots, part) == body.roots.end()) trees_.push_back(root_tree(body, part));
    }
    find_consistent_pairs();
  }

  std::vector<Skeleton> run() {
    std::vector<Skeleton> people;
    std::vector<std::vector<char>> rejected(trees_.size(), std::vector<char>(clusters_.size(), 0));
    bool changed = true;
    while (true) {
      if (changed) accumulate_all();
      changed = false;
      const auto [tree, root] = best_root(rejected);
      if (root < 0) break;
      Skeleton found = extract(tree, root);
      if (accepted(found)) {
        for (const SkeletonPart& part : found.parts) {
          if (part.cluster >= 0) used_[part.cluster] = true;
        }
        people.push_back(std::move(found));
        changed = true;
      } else {
        rejected[tree][root] = 1;
      }
    }
    return people;
  }

 private:
  /// Returns the likelihood that a part of this size adds: 1 for a feasible area, less for slivers and slabs.
  float gain(const PartCluster& cluster) const {
    const float share = cluster.area_m2 / body_.parts[cluster.label].typical_area_m2;
    const float off = std::max({0.F, std::log(kLeastAreaShare / share), std::log(share / kMostAreaShare)});
    return std::exp2(-off / kSizeTolerance);
  }

  void find_consistent_pairs() {
    one_step_.resize(clusters_.size());
    two_step_.resize(clusters_.size());
    for (const BodyLink& link : body_.links) add_pairs(link.parent, link.child, span_of(link, size_), one_step_);
    if (!options_.grandparents) return;
    for (std::size_t i = 0; i < body_.links.size(); ++i) {
      for (std::size_t j = i + 1; j < body_.links.size(); ++j) {
        const BodyLink &a = body_.links[i], &b = body_.links[j];
        const Span span = span_of(a, b, size_);
        if (a.child == b.parent) add_pairs(a.parent, b.child, span, two_step_);
        if (b.child == a.parent) add_pairs(b.parent, a.child, span, two_step_);
        if (a.parent == b.parent) add_pairs(a.child, b.child, span, two_step_);
        if (a.child == b.child) add_pairs(a.parent, b.parent, span, two_step_);
      }
    }
  }

  void add_pairs(int part_a, int part_b, const Span& span, std::vector<std::vector<Partner>>& pairs) const {
    for (const int i : by_part_[part_a]) {
      for (const int j : by_part_[part_b]) {
        const float error = normalised_distance(clusters_[i], clusters_[j], span, options_);
        if (error > options_.max_error) continue;
        pairs[i].push_back({j, error});
        pairs[j].push_back({i, error});
      }
    }
  }

  /// Returns the best accumulated likelihood over the partners of `from` that are of part `part`; its value is 0 if
  /// there is none.
  Branch best_partner(int from, int part, const std::vector<std::vector<Partner>>& pairs,
                      const std::vector<float>& values) const {
    Branch best;
    for (const Partner& partner : pairs[from]) {
      const auto j = static_cast<std::size_t>(partner.cluster);
      if (used_[j] || clusters_[j].label != part) continue;
      const float value = values[j] - options_.error_weight * partner.error * partner.error;
      if (value > best.value) best = {value, {partner}};
    }
    return best;
  }

  /// Returns the better of the child and, skipping it, its children (section 6: two degrees of separation).
  Branch best_branch(const RootedTree& tree, int from, int child, const std::vector<float>& values) const {
    Branch direct = best_partner(from, child, one_step_, values);
    Branch skipped;
    for (const int grandchild : tree.children[child]) {
      const Branch one = best_partner(from, grandchild, two_step_, values);
      skipped.value += one.value;
      skipped.partners.insert(skipped.partners.end(), one.partners.begin(), one.partners.end());
    }
    return skipped.value > direct.value ? skipped : direct;
  }

  /// Returns the likelihood of the best subtree under every cluster, leaves first.
  std::vector<float> accumulate(const RootedTree& tree) const {
    std::vector<float> values(clusters_.size(), 0.F);
    for (auto part = tree.order.rbegin(); part != tree.order.rend(); ++part) {
      for (const int i : by_part_[*part]) {
        if (used_[i]) continue;
        float value = gains_[i];
        for (const int child : tree.children[*part]) {
          value += best_branch(tree, i, child, values).value;
        }
        values[i] = value;
      }
    }
    return values;
  }

  void accumulate_all() {
    values_.clear();
    for (const RootedTree& tree : trees_) values_.push_back(accumulate(tree));
  }

  struct Root {
    std::size_t tree = 0;
    int cluster = -1;
  };

  Root best_root(const std::vector<std::vector<char>>& rejected) const {
    Root best;
    float best_value = 0.F;
    for (std::size_t t = 0; t < trees_.size(); ++t) {
      for (const int i : by_part_[trees_[t].root]) {
        const auto c = static_cast<std::size_t>(i);
        if (used_[c] || rejected[t][c] != 0 || values_[t][c] <= best_value) continue;
        best_value = values_[t][c];
        best = {t, i};
      }
    }
    return best;
  }

  Skeleton extract(std::size_t t, int root) const {
    Skeleton out;
    out.parts.resize(body_.parts.size());
    out.root = trees_[t].root;
    out.score = values_[t][root];
    std::vector<Partner> open{{root, 0.F}};
    while (!open.empty()) {
      const Partner at = open.back();
      open.pop_back();
      const PartCluster& cluster = clusters_[at.cluster];
      out.parts[cluster.label] = make_part(at);
      ++out.found;
      out.total_error += at.error;
      for (const int child : trees_[t].children[cluster.label]) {
        const Branch branch = best_branch(trees_[t], at.cluster, child, values_[t]);
        open.insert(open.end(), branch.partners.begin(), branch.partners.end());
      }
    }
    out.mean_error = out.total_error / float(out.found);
    return out;
  }

  SkeletonPart make_part(const Partner& at) const {
    const PartCluster& cluster = clusters_[at.cluster];
    return {State::observed,  at.cluster,
            cluster.centroid, cluster.eigenvalues.cwiseSqrt(),
            at.error,         gains_[at.cluster] * std::exp(-0.5F * at.error * at.error)};
  }

  bool accepted(const Skeleton& s) const {
    return s.found >= options_.min_parts && s.total_error <= options_.max_total_error &&
           s.mean_error <= options_.max_mean_error;
  }

  const std::vector<PartCluster>& clusters_;
  const BodyModel& body_;
  const SearchOptions& options_;
  const float size_;
  std::vector<char> used_;                 ///< [cluster] belongs to a person already
  std::vector<std::vector<int>> by_part_;  ///< [part] clusters
  std::vector<float> gains_;               ///< [cluster]
  std::vector<RootedTree> trees_;
  std::vector<std::vector<Partner>> one_step_;  ///< [cluster] consistent over one link
  std::vector<std::vector<Partner>> two_step_;  ///< [cluster] consistent over two links
  std::vector<std::vector<float>> values_;      ///< [tree][cluster] accumulated likelihood
};

}  // namespace

std::vector<Skeleton> search_skeletons(const std::vector<PartCluster>& clusters, const BodyModel& body,
                                       const SearchOptions& options, float size) {
  return SkeletonSearch(clusters, body, options, size).run();
}

}  // namespace vesalius
