#include "vesalius/score_person.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "vesalius/base/body_heading.h"
#include "vesalius/derive_joints.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/row_kernels.h"

namespace vesalius {
namespace {

constexpr float kExplainedRadius_m = 0.25F;  // a pixel is explained by an observed part of its label this near
constexpr int kOpenStep_mm = 100;            // an outline stands free where what lies behind is this much further
/// Number of pixels without a reading that are skipped at the outline, because silhouettes have a rim without any.
constexpr int kRim = 5;

/// The pixels of a mask.
class Inside {
 public:
  explicit Inside(const Mask& mask) : mask_(mask) {
    const Box box = bounding_box(mask);
    for (int v = box.v; v < box.v + box.height; ++v) {
      for (int u = box.u; u < box.u + box.width; ++u) {
        if (mask(u, v) != 0) pixels_.push_back({u, v});
      }
    }
  }
  const Mask& mask() const { return mask_; }

  /// Calls `use(u, v)` for each, row by row.
  template <class Use>
  void each(Use&& use) const {
    for (const auto& [u, v] : pixels_) use(u, v);
  }

 private:
  const Mask& mask_;
  std::vector<std::array<int, 2>> pixels_;
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
  return pixels > 0 ? float(explained) / float(pixels) : 0.F;
}

/// The surroundings of the outline: counts of the sides of a mask's pixels by what is beyond them.
struct Outline {
  long open = 0;      ///< further away, or without a reading
  long closed = 0;    ///< at the same distance
  long occluded = 0;  ///< nearer
  long border = 0;    ///< at the end of the picture
  long sides = 0;     ///< all

  float share_open() const { return share(open, open + closed); }
  float share_occluded() const { return share(occluded, open + closed + occluded); }
  float share_border() const { return share(border, open + closed + occluded + border); }

 private:
  static float share(long some, long all) { return all > 0 ? float(some) / float(all) : 0.F; }
};

Outline outline_of(const Frame& frame, const Inside& inside) {
  const Mask& mask = inside.mask();
  constexpr std::array<std::array<int, 2>, 4> kSides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  Outline outline;
  inside.each([&](int u, int v) {
    for (const auto& [du, dv] : kSides) {
      if (!mask.contains(u + du, v + dv)) {
        ++outline.border;
        ++outline.sides;
        continue;
      }
      if (mask(u + du, v + dv) != 0) continue;
      ++outline.sides;
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

constexpr int kShareSteps = 256;

/// Returns the body share that the given share of the pixels exceed, from the number of pixels in each step of it.
float share_exceeded(const std::array<long, kShareSteps>& of_step, long pixels, double share) {
  if (pixels == 0) return 0.F;
  const double most = share * double(pixels);
  int step = kShareSteps - 1;
  for (long above = of_step[step]; step > 0 && double(above) <= most;) above += of_step[--step];
  return (float(step) + 0.5F) / kShareSteps;
}

/// What the forest says of the pixels of a mask.
struct Belief {
  float body = 1.F;          ///< mean body share; 0 without pixels
  float surest = 0.F;        ///< body share that a tenth exceed
  std::vector<float> parts;  ///< shares of the parts in the body, by slot
};

Belief belief_of(const Inside& inside, const Posteriors& posteriors, const BodyModel& body) {
  const int parts = body.part_count();
  const std::vector<int> slots = part_slots(body);
  std::array<long, kShareSteps> of_step{};
  std::vector<double> of_part(parts, 0.0);
  double sum = 0.0;
  long pixels = 0;
  inside.each([&](int u, int v) {
    const std::optional<double> share = body_share(posteriors, u, v, parts);
    if (!share) return;
    sum += *share;
    ++pixels;
    ++of_step[std::min(kShareSteps - 1, int(*share * kShareSteps))];
    const std::uint16_t* sums = posteriors.at(u, v);
    const int of_body = std::accumulate(sums, sums + parts, 0);
    if (of_body == 0) return;
    const double unit = 1.0 / of_body;
    for (int p = 0; p < parts; ++p) of_part[p] += unit * sums[p];
  });
  Belief belief;
  const auto count = double(std::max(1L, pixels));
  belief.body = float(sum / count);
  belief.parts.resize(kind_count(slots), 0.F);
  for (int p = 0; p < parts; ++p) belief.parts[slots[p]] += float(of_part[p] / count);
  belief.surest = share_exceeded(of_step, pixels, 0.1);
  return belief;
}

/// The shape of a mask's surface.
struct Shape {
  float depth_m = 0.F, length_m = 0.F, slant = 0.F, bend_m = 0.F;  ///< as Evidence's
};

/// Returns Evidence::bend_m. Where the points to both sides are far off, the surface ends between them.
float bend_of(const Frame& frame, const Inside& inside) {
  constexpr float kFarOff_m = 0.15F;
  const Mask& mask = inside.mask();
  const auto holds = [&](int u, int v) { return mask.contains(u, v) && mask(u, v) != 0; };
  double sum = 0.0;
  long pairs = 0;
  inside.each([&](int u, int v) {
    const auto z_mm = float(std::max<int>(1, frame.depth(u, v)));
    const int reach = std::max(1, int(std::lround(kBendReach_m * frame.camera.fx / (1e-3F * z_mm))));
    for (const auto& [du, dv] : {std::array{reach, 0}, std::array{0, reach}}) {
      if (!holds(u + du, v + dv) || !holds(u - du, v - dv)) continue;
      const auto middle = 0.5F * float(frame.depth(u + du, v + dv) + frame.depth(u - du, v - dv));
      const float off = 1e-3F * std::abs(middle - z_mm);
      if (off > kFarOff_m) continue;
      sum += double(off);
      ++pairs;
    }
  });
  return pairs > 0 ? float(sum / double(pairs)) : 0.F;
}

Shape shape_of(const Frame& frame, const Inside& inside) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  long pixels = 0;
  inside.each([&](int u, int v) {
    const Eigen::Vector3d point = point_at(frame.camera, frame.depth, u, v).cast<double>();
    sum += point;
    squares += point * point.transpose();
    ++pixels;
  });
  if (pixels == 0) return {};
  const auto count = double(pixels);
  const Eigen::Matrix3d covariance = squares / count - sum * sum.transpose() / (count * count);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const Eigen::Vector3d spread = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return {float(spread[0]), float(spread[2]), float(std::abs(axes.eigenvectors().col(0).z())), bend_of(frame, inside)};
}

/// Returns how many pixels of a mask have a flat surface close beside them, at about their depth.
long count_on_flat(const Frame& frame, const Inside& inside, const Mask& flat) {
  constexpr int kAside = 3;
  constexpr int kClose_mm = 150;
  constexpr std::array<std::array<int, 2>, 4> kSides{{{-kAside, 0}, {kAside, 0}, {0, -kAside}, {0, kAside}}};
  long pixels = 0;
  inside.each([&](int u, int v) {
    const auto touches = [&](const std::array<int, 2>& side) {
      const int su = u + side[0], sv = v + side[1];
      return flat.contains(su, sv) && flat(su, sv) != 0 &&
             std::abs(frame.depth(su, sv) - frame.depth(u, v)) < kClose_mm;
    };
    pixels += std::ranges::any_of(kSides, touches) ? 1 : 0;
  });
  return pixels;
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
    extent.area_m2 += z * z / (double(frame.camera.fx) * double(frame.camera.fy));
    extent.mean_depth_m += z;
    ++extent.pixels;
  });
  if (extent.pixels > 0) extent.mean_depth_m /= double(extent.pixels);
  return extent;
}

float likeness_of_area(const Extent& extent) {
  constexpr auto kUsual = double(kUsualArea_m2);
  return float(std::min(extent.area_m2, kUsual) / std::max(extent.area_m2, kUsual));
}

float nearness(const Extent& extent) { return float(1.0 / std::max(1.0, extent.mean_depth_m)); }

float resolution_of(const Extent& extent) {
  constexpr double kDecades = 5.0;
  return float(std::log10(double(std::max(1L, extent.pixels))) / kDecades);
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
  return pixels > 0 ? float(sum / double(pixels)) : 0.F;
}

}  // namespace

float mean_body_outside(const Mask& candidates, const DepthImage& depth, const Posteriors& posteriors, int parts) {
  constexpr int kEvery = 2;
  double sum = 0.0;
  long pixels = 0;
  std::vector<std::uint8_t> skip(static_cast<std::size_t>(depth.width()), 1);
  std::vector<BodySums> sums(skip.size());
  for (int v = 0; v < depth.height(); v += kEvery) {
    for (int u = 0; u < depth.width(); u += kEvery) skip[u] = depth(u, v) == 0 || candidates(u, v) != 0 ? 1 : 0;
    sum_bodies(posteriors, 0, v, parts, skip.data(), depth.width(), sums.data());
    for (const BodySums& of : sums) {
      const std::optional<double> share = of.share();
      if (!share) continue;
      sum += *share;
      ++pixels;
    }
  }
  return pixels > 0 ? float(sum / double(pixels)) : 0.F;
}

namespace {

/// Returns Evidence::lacking: an outline that is hidden or cut off excuses missing parts.
float lacking_of(const Evidence& evidence) {
  constexpr float kWhole = 0.6F;  // likelihood of people of whom hardly a part is missing
  constexpr float kExcuse = 1.5F;
  const float shown = std::max(0.F, 1.F - kExcuse * (evidence.border + evidence.occluded));
  return std::max(0.F, kWhole - evidence.likelihood) * shown;
}

}  // namespace

Evidence gather_evidence(const Frame& frame, const Mask& mask, const PersonLabels& labels, const Posteriors& posteriors,
                         const Scenery& scenery, const Skeleton& skeleton, const BodyModel& body) {
  const Inside inside(mask);
  const Outline outline = outline_of(frame, inside);
  const Extent extent = extent_of(frame, inside);
  const Shape shape = shape_of(frame, inside);
  Belief belief = belief_of(inside, posteriors, body);
  Evidence evidence;
  evidence.likelihood = skeleton.score / float(body.part_count());
  evidence.explained = share_explained(frame, inside, labels.labels, skeleton, body);
  evidence.open = outline.share_open();
  evidence.core = share_of_core(skeleton, body);
  evidence.body = belief.body;
  evidence.size = likeness_of_area(extent);
  evidence.occluded = outline.share_occluded();
  evidence.near = nearness(extent);
  evidence.certain = labels.certain;
  evidence.border = outline.share_border();
  evidence.beside = body_beside(inside, posteriors, body.part_count());
  evidence.resolution = resolution_of(extent);
  evidence.surest = belief.surest;
  evidence.facing = labels.facing.size() > 0 ? labels.facing.maxCoeff() : 0.F;
  evidence.depth_m = shape.depth_m;
  evidence.length_m = shape.length_m;
  evidence.slant = shape.slant;
  evidence.bend_m = shape.bend_m;
  const float side = std::sqrt(float(std::max(1L, extent.pixels)));
  evidence.ragged = float(outline.sides) / side;
  evidence.on_flat = float(count_on_flat(frame, inside, scenery.flat)) / side;
  evidence.elsewhere = scenery.body_elsewhere;
  evidence.rivals = float(scenery.proposals);
  evidence.groups = float(scenery.groups);
  evidence.lacking = lacking_of(evidence);
  evidence.parts = std::move(belief.parts);
  return evidence;
}

float agreement_of_sides(const Skeleton& skeleton, const YawEstimate& heading, const BodyModel& body) {
  if (skeleton.found == 0) return 0.F;
  const std::optional<float> yaw = body_yaw(given_centres(skeleton), body);
  return yaw ? std::cos(*yaw - heading.yaw_rad) : 0.F;
}

void add_votes(const Frame& frame, const Mask& mask, const Image<PersonVote>& votes, const VoteGroup& group,
               const Skeleton& skeleton, const BodyModel& body, Evidence& evidence) {
  long all = 0, agreeing = 0;
  for (int row = 0; row < votes.height(); ++row) {
    for (int column = 0; column < votes.width(); ++column) {
      const int u = column * kVoteStep, v = row * kVoteStep;
      if (mask(u, v) == 0 || frame.depth(u, v) == 0) continue;
      ++all;
      agreeing += (voted_middle(votes, frame, column, row) - group.middle).norm() <= kAgreed_m ? 1 : 0;
    }
  }
  constexpr float kLeastDoubt = 1e-3F;
  evidence.votes = std::log10(float(group.votes));
  evidence.spread_m = group.spread_m;
  evidence.likely = std::log(group.body / (1.F - group.body + kLeastDoubt));
  evidence.agree = all > 0 ? float(agreeing) / float(all) : 0.F;
  evidence.heading = group.heading.confidence;
  evidence.sided = agreement_of_sides(skeleton, group.heading, body);
}

std::vector<std::string> judge_names(const BodyModel& body) {
  const std::vector<std::string> kinds = kind_names(body);
  std::vector<std::string> names;
  names.reserve(kJudgedEvidence.size() + kinds.size() + kVotedEvidence.size());
  for (const JudgedEvidence& kind : kJudgedEvidence) names.emplace_back(kind.name);
  for (const std::string& name : kinds) names.push_back("part:" + name);
  for (const JudgedEvidence& kind : kVotedEvidence) names.emplace_back(kind.name);
  return names;
}

std::vector<int> judge_signs(const BodyModel& body) {
  const std::size_t parts = kind_count(part_slots(body));
  std::vector<int> signs;
  signs.reserve(kJudgedEvidence.size() + parts + kVotedEvidence.size());
  for (const JudgedEvidence& kind : kJudgedEvidence) signs.push_back(kind.sign);
  signs.resize(signs.size() + parts, 0);
  for (const JudgedEvidence& kind : kVotedEvidence) signs.push_back(kind.sign);
  return signs;
}

std::vector<float> judge_features(const Evidence& evidence) {
  std::vector<float> features;
  features.reserve(kJudgedEvidence.size() + evidence.parts.size() + kVotedEvidence.size());
  for (const JudgedEvidence& kind : kJudgedEvidence) features.push_back(evidence.*kind.evidence);
  features.insert(features.end(), evidence.parts.begin(), evidence.parts.end());
  for (const JudgedEvidence& kind : kVotedEvidence) features.push_back(evidence.*kind.evidence);
  return features;
}

}  // namespace vesalius
