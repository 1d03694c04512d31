#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"
#include "vesalius/find_clusters.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {

struct GrowOptions {
  float radius_m = 0.05F;           ///< 3-D distance that neighbouring pixels of a person may have
  float radius_per_z2 = 0.003F;     ///< added per square metre of depth: a structured-light sensor's depth step
  float reach_m = 0.3F;             ///< how far a person extends around the centre of a part
  float missing_reach_m = 0.2F;     ///< added for each unseen part beyond, once
  float hue_tolerance_deg = 5.F;    ///< blur of the learned hues
  float lightness_tolerance = 8.F;  ///< blur of the learned lightness of greys, of 255
  float min_saturation = 0.2F;      ///< below it a colour counts as grey: its hue means nothing
  float colour_veto = 2.F;          ///< log of how much less likely on the person than elsewhere a colour is refused
  float own_colour_m = 0.12F;       ///< this near to a part's centre any colour is the person's
  bool use_colour = true;
  PlaneOptions plane;
};
void visit_options(const std::string& prefix, GrowOptions& options, OptionVisitor& visitor);

/// Learned look (section 7): frequency of hues, and of lightness for greys, as a distribution over bins.
class ColourModel {
 public:
  static constexpr int kHues = 72;   ///< 5 degrees each
  static constexpr int kGreys = 32;  ///< 8 lightness steps each
  static constexpr int kBins = kHues + kGreys;

  /// Bin of a colour: its hue, or its lightness where saturation is too low for a hue.
  static int bin(Rgb colour, float min_saturation);

  void add(int bin) { ++counts_[bin]; }
  /// Blurs over the tolerances (hues wrap) and normalises; an empty model is uniform.
  void finish(const GrowOptions& options);
  float probability(int bin) const { return probabilities_[bin]; }

 private:
  std::array<std::uint32_t, kBins> counts_{};
  std::array<float, kBins> probabilities_{};
};

/// Grows people from rough skeletons in one frame (section 7): Euclidean clustering by place and colour, seeded with
/// the pixels of the skeleton's proposals, within the body's reach, never along floor, walls or other people.
class PersonGrower {
 public:
  /// Keeps references: frame and options must outlive it.
  PersonGrower(const Frame& frame, const BodyModel& body, const GrowOptions& options);

  /// Masks of the people, 1 inside, one per skeleton. They grow at the same pace from their own proposals, so that
  /// people who touch share the pixels between them by nearness.
  std::vector<Mask> grow(const std::vector<Skeleton>& people, const Clusters& clusters) const;

  /// 1 on pixels of floor, walls and other large flat surfaces.
  const Mask& flat() const { return flat_; }

 private:
  /// 1 on pixels within `radius_m[part]` of each observed part's centre; 0 = not at all.
  Mask around_parts(const Skeleton& rough, const std::vector<float>& radius_m) const;
  /// Of every pixel: worked out when first asked for, for most frames have nobody.
  const std::vector<std::uint8_t>& colour_bins() const;
  Mask refused_colours(const Skeleton& rough, const Mask& seeds, const Mask& reach) const;

  const Frame& frame_;
  const BodyModel& body_;
  const GrowOptions& options_;
  Mask flat_;
  mutable std::once_flag binned_;
  mutable std::vector<std::uint8_t> colour_bins_;
};

}  // namespace vesalius
