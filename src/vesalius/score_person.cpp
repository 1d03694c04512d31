#include "vesalius/score_person.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace vesalius {
namespace {

constexpr float kExplainedRadius_m = 0.25F;  // a pixel is explained by an observed part of its label this near
constexpr int kOpenStep_mm = 100;            // an outline stands free where what lies behind is this much further
/// Number of pixels without a reading that are skipped at the outline, because silhouettes have a rim without any.
constexpr int kRim = 5;

/// The pixels of a mask.
class Inside {
 public:
  explicit Inside(const Mask& mask) : mask_(mask), box_(bounding_box(mask)) {}
  const Mask& mask() const { return mask_; }

  /// Calls `use(u, v)` for each, row by row.
  template <class Use>
  void each(Use&& use) const {
    for (int v = box_.v; v < box_.v + box_.height; ++v) {
      for (int u = box_.u; u < box_.u + box_.width; ++u) {
        if (mask_(u, v) != 0) use(u, v);
      }
    }
  }

 private:
  const Mask& mask_;
  Box box_;
};

bool near_part(const Skeleton& skeleton, int part, const Eigen::Vector3f& point) {
  const SkeletonPart& found = skeleton.parts[part];
  return found.state == State::observed &&
         (found.centre - point).squaredNorm() <= kExplainedRadius_m * kExplainedRadius_m;
}

float share_explained(const Frame& frame, const Inside& inside, const LabelImage& labels, const Skeleton& skeleton,
                      const BodyModel& body) {
  long pixels = 0;
  long explained = 0;
  inside.each([&](int u, int v) {
    ++pixels;
    const int label = labels(u, v);
    if (label >= body.part_count()) return;
    const Eigen::Vector3f point = point_at(frame.camera, frame.depth, u, v);
    // Seen from the side a labelling mixes left and right; either is an explanation.
    const int mirror = body.parts[label].mirror;
    if (near_part(skeleton, label, point) || near_part(skeleton, mirror, point)) ++explained;
  });
  return pixels > 0 ? static_cast<float>(explained) / static_cast<float>(pixels) : 0.F;
}

/// The surroundings of the outline: counts of the sides of a mask's pixels by what is beyond them.
struct Outline {
  long open = 0;      ///< further away, or without a reading
  long closed = 0;    ///< at the same distance
  long occluded = 0;  ///< nearer
  long border = 0;    ///< at the end of the picture

  float share_open() const { return share(open, open + closed); }
  float share_occluded() const { return share(occluded, open + closed + occluded); }
  float share_border() const { return share(border, open + closed + occluded + border); }

 private:
  static float share(long some, long all) { return all > 0 ? static_cast<float>(some) / static_cast<float>(all) : 0.F; }
};

Outline look_around(const Frame& frame, const Inside& inside) {
  const Mask& mask = inside.mask();
  constexpr std::array<std::array<int, 2>, 4> kSides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  Outline outline;
  inside.each([&](int u, int v) {
    for (const auto& [du, dv] : kSides) {
      if (!mask.contains(u + du, v + dv)) {
        ++outline.border;
        continue;
      }
      if (mask(u + du, v + dv) != 0) continue;
      int beyond = 0;
      for (int k = 1; k <= kRim && beyond == 0 && mask.contains(u + k * du, v + k * dv); ++k) {
        beyond = frame.depth(u + k * du, v + k * dv);
      }
      const int here = frame.depth(u, v);
      if (beyond == 0 || beyond > here + kOpenStep_mm) {
        ++outline.open;
      } else if (beyond >= here - kOpenStep_mm) {
        ++outline.closed;
      } else {
        ++outline.occluded;
      }
    }
  });
  return outline;
}

/// Returns the mean over the mask of the parts' share of all classes: 1 if there is no background class, 0 without
/// pixels.
float share_of_body(const Inside& inside, const Posteriors& posteriors, int parts) {
  double sum = 0.0;
  long pixels = 0;
  inside.each([&](int u, int v) {
    const std::optional<double> share = body_share(posteriors, u, v, parts);
    if (!share) return;
    sum += *share;
    ++pixels;
  });
  return pixels > 0 ? static_cast<float>(sum / static_cast<double>(pixels)) : 0.F;
}

/// The size of a mask and its distance.
struct Extent {
  long pixels = 0;
  double area_m2 = 0.0;
  double mean_depth_m = 0.0;  ///< 0 without pixels
};

Extent extent_of(const Frame& frame, const Inside& inside) {
  Extent extent;
  inside.each([&](int u, int v) {
    const double z = 1e-3 * frame.depth(u, v);
    extent.area_m2 += z * z / (static_cast<double>(frame.camera.fx) * static_cast<double>(frame.camera.fy));
    extent.mean_depth_m += z;
    ++extent.pixels;
  });
  if (extent.pixels > 0) extent.mean_depth_m /= static_cast<double>(extent.pixels);
  return extent;
}

float likeness_of_area(const Extent& extent) {
  constexpr auto kUsual = static_cast<double>(kUsualArea_m2);
  return static_cast<float>(std::min(extent.area_m2, kUsual) / std::max(extent.area_m2, kUsual));
}

float nearness(const Extent& extent) { return static_cast<float>(1.0 / std::max(1.0, extent.mean_depth_m)); }

float resolution_of(const Extent& extent) {
  constexpr double kDecades = 5.0;
  return static_cast<float>(std::log10(static_cast<double>(std::max(1L, extent.pixels))) / kDecades);
}

float share_of_core(const Skeleton& skeleton, const BodyModel& body) {
  std::vector<char> core(body.parts.size(), 0);
  for (const int root : body.roots) {
    core[root] = 1;
    for (const BodyLink& link : body.links) {
      if (link.parent == root) core[link.child] = 1;
      if (link.child == root) core[link.parent] = 1;
    }
  }
  float all = 0.F;
  float found = 0.F;
  for (std::size_t i = 0; i < core.size(); ++i) {
    if (core[i] == 0) continue;
    all += 1.F;
    if (skeleton.parts[i].state == State::observed) found += 1.F;
  }
  return all > 0.F ? found / all : 0.F;
}

/// Returns the mean body share of the pixels kAside pixels beside the mask's on their four sides.
float body_beside(const Inside& inside, const Posteriors& posteriors, int parts) {
  constexpr int kAside = 4;
  constexpr std::array<std::array<int, 2>, 4> kSides{{{-kAside, 0}, {kAside, 0}, {0, -kAside}, {0, kAside}}};
  const Mask& mask = inside.mask();
  double sum = 0.0;
  long pixels = 0;
  inside.each([&](int u, int v) {
    for (const auto& [du, dv] : kSides) {
      if (!mask.contains(u + du, v + dv) || mask(u + du, v + dv) != 0) continue;
      const std::optional<double> share = body_share(posteriors, u + du, v + dv, parts);
      if (!share) continue;
      sum += *share;
      ++pixels;
    }
  });
  return pixels > 0 ? static_cast<float>(sum / static_cast<double>(pixels)) : 0.F;
}

}  // namespace

void visit_options(const std::string& prefix, ScoreOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "likelihood-weight", o.likelihood_weight,
                 {"", -1000.0, 1000.0, "Weight of the skeleton's likelihood in a person's score."});
  visitor.option(prefix + "explained-weight", o.explained_weight,
                 {"", -1000.0, 1000.0, "Weight of the share of the mask that the skeleton explains."});
  visitor.option(prefix + "open-weight", o.open_weight,
                 {"", -1000.0, 1000.0, "Weight of the share of the outline that stands free."});
  visitor.option(prefix + "core-weight", o.core_weight,
                 {"", -1000.0, 1000.0, "Weight of the share of head, neck and chest parts found."});
  visitor.option(prefix + "body-weight", o.body_weight,
                 {"", -1000.0, 1000.0, "Weight of how sure the forest is that the mask is body."});
  visitor.option(prefix + "size-weight", o.size_weight,
                 {"", -1000.0, 1000.0, "Weight of how near the mask's area is to a person's."});
  visitor.option(prefix + "occluded-weight", o.occluded_weight,
                 {"", -1000.0, 1000.0, "Weight of the share of the outline that something nearer cuts off."});
  visitor.option(prefix + "near-weight", o.near_weight, {"", -1000.0, 1000.0, "Weight of how near the camera it is."});
  visitor.option(prefix + "certain-weight", o.certain_weight,
                 {"", -1000.0, 1000.0, "Weight of how sure the second pass is which part each pixel is."});
  visitor.option(prefix + "border-weight", o.border_weight,
                 {"", -1000.0, 1000.0, "Weight of the share of the outline that the picture's border cuts off."});
  visitor.option(prefix + "beside-weight", o.beside_weight,
                 {"", -1000.0, 1000.0, "Weight of how much body the forest sees beside the mask."});
  visitor.option(prefix + "resolution-weight", o.resolution_weight,
                 {"", -1000.0, 1000.0, "Weight of the logarithm of the mask's number of pixels."});
  visitor.option(prefix + "bias", o.bias, {"", -1000.0, 1000.0, "Constant of the score."});
}

ScoreOptions score_without_background() {
  ScoreOptions options;
  options.likelihood_weight = 8.6F;
  options.explained_weight = 3.4F;
  options.open_weight = 7.3F;
  options.core_weight = 8.1F;
  options.body_weight = 0.F;
  options.size_weight = 0.F;
  options.occluded_weight = 0.F;
  options.near_weight = 0.F;
  options.certain_weight = 0.F;
  options.border_weight = 0.F;
  options.beside_weight = 0.F;
  options.resolution_weight = 0.F;
  options.bias = -18.65F;
  return options;
}

Evidence gather_evidence(const Frame& frame, const Mask& mask, const PersonLabels& labels, const Posteriors& posteriors,
                         const Skeleton& skeleton, const BodyModel& body) {
  const Inside inside(mask);
  const Outline outline = look_around(frame, inside);
  const Extent extent = extent_of(frame, inside);
  return {skeleton.score / static_cast<float>(body.part_count()),
          share_explained(frame, inside, labels.labels, skeleton, body),
          outline.share_open(),
          share_of_core(skeleton, body),
          share_of_body(inside, posteriors, body.part_count()),
          likeness_of_area(extent),
          outline.share_occluded(),
          nearness(extent),
          labels.certain,
          outline.share_border(),
          body_beside(inside, posteriors, body.part_count()),
          resolution_of(extent)};
}

float person_score(const Evidence& e, const ScoreOptions& o) {
  float sum = 0.F;
  for (const EvidenceWeight& piece : kEvidenceWeights) sum += o.*piece.weight * e.*piece.evidence;
  sum += o.bias;
  return 1.F / (1.F + std::exp(-sum));
}

}  // namespace vesalius
