#include "link_lengths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/find_clusters.h"

namespace vesalius {
namespace {

constexpr double kCovered = 0.9;

struct Weighted {
  float value;
  double weight;
};

/// Returns the value up to which a share of all weight lies; NaN without values.
float quantile(std::vector<Weighted> values, double share) {
  std::ranges::sort(values, {}, &Weighted::value);
  double all = 0.0;
  for (const Weighted& value : values) all += value.weight;
  double sum = 0.0;
  for (const Weighted& value : values) {
    sum += value.weight;
    if (sum >= share * all) return value.value;
  }
  return std::numeric_limits<float>::quiet_NaN();
}

float median(const std::vector<Weighted>& values) { return quantile(values, 0.5); }

/// Returns the deviation from the median that a share of all weight does not exceed.
float spread(std::vector<Weighted> values) {
  const float centre = median(values);
  for (Weighted& value : values) value.value = std::abs(value.value - centre);
  return quantile(std::move(values), kCovered);
}

std::size_t band_of(float stature_m) {
  return static_cast<std::size_t>(std::ranges::upper_bound(kStatureBands_m, stature_m) - kStatureBands_m.begin());
}

/// Returns the labels of one person's pixels.
LabelImage labels_of(const TrueFrame& frame, const LabelImage& labels, std::size_t person) {
  LabelImage out = labels;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (frame.truth.person[i] != person) out[i] = kBackground;
  }
  return out;
}

/// Returns [part] the largest cluster, or null.
std::vector<const PartCluster*> largest(const Clusters& clusters, int parts) {
  std::vector<const PartCluster*> out(static_cast<std::size_t>(parts), nullptr);
  for (const PartCluster& cluster : clusters.items) {  // largest first within each label
    if (out[cluster.label] == nullptr) out[cluster.label] = &cluster;
  }
  return out;
}

}  // namespace

LinkLengths::LinkLengths(const BodyModel& body) : body_(body), samples_(body.links.size()) {
  const auto same = [&](const BodyLink& a, const BodyLink& b) {
    return body.parts[a.parent].mirror == b.parent && body.parts[a.child].mirror == b.child;
  };
  for (std::size_t i = 0; i < body.links.size(); ++i) {
    const auto twin = std::find_if(body.links.begin(), body.links.begin() + static_cast<std::ptrdiff_t>(i),
                                   [&](const BodyLink& other) { return same(other, body.links[i]); });
    twin_.push_back(static_cast<int>(twin - body.links.begin()));
  }
}

void LinkLengths::add(const TrueFrame& frame, const LabelImage& labels) {
  for (std::size_t person = 0; person < frame.truth.statures_m.size(); ++person) {
    const float stature = frame.truth.statures_m[person];
    if (!std::isfinite(stature)) continue;
    const Clusters clusters =
        find_clusters(labels_of(frame, labels, person), frame.frame.depth, frame.frame.camera, body_, {});
    const std::vector<const PartCluster*> parts = largest(clusters, body_.part_count());
    for (std::size_t link = 0; link < body_.links.size(); ++link) {
      const PartCluster* a = parts[body_.links[link].parent];
      const PartCluster* b = parts[body_.links[link].child];
      if (a != nullptr && b != nullptr) {
        samples_[twin_[link]].push_back({(a->centroid - b->centroid).norm(), stature});
      }
    }
  }
}

std::vector<LinkFigures> LinkLengths::figures() const {
  std::vector<LinkFigures> out;
  for (const int twin : twin_) {
    std::array<std::vector<Weighted>, kStatureBands_m.size() + 1> bands;
    for (const Sample& sample : samples_[twin]) bands[band_of(sample.stature_m)].push_back({sample.distance_m, 1.0});
    std::vector<Weighted> distances, scaled;
    for (const Sample& sample : samples_[twin]) {
      const double weight = 1.0 / static_cast<double>(bands[band_of(sample.stature_m)].size());
      distances.push_back({sample.distance_m, weight});
      scaled.push_back({sample.distance_m * kReferenceStature_m / sample.stature_m, weight});
    }
    LinkFigures& figures = out.emplace_back();
    figures.pairs = static_cast<long>(distances.size());
    figures.length_m = median(distances);
    figures.spread_m = spread(distances);
    figures.scaled_spread_m = spread(scaled);
    std::ranges::transform(bands, figures.band_m.begin(), median);
  }
  return out;
}

}  // namespace vesalius
