#pragma once

#include <array>
#include <cstdint>
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
  float radius_m = 0.05F;        ///< 3-D distance that neighbouring pixels of a person may have
  float radius_per_z2 = 0.003F;  ///< added per square metre of depth: a structured-light sensor's depth step
  float reach_m = 0.3F;          ///< how far a person extends around the centre of a part
  float missing_reach_m = 0.2F;  ///< added once for each unseen part beyond
  float colour_veto = 2.F;       ///< a colour is refused if it is likelier elsewhere by this, as a log of the ratio
  float own_colour_m = 0.12F;    ///< any colour this near to a part's centre is the person's
  bool use_colour = true;
  float least_body = 0.25F;  ///< least body share of the posterior of pixels that a person grows over
  PlaneOptions plane;
};
void visit_options(const std::string& prefix, GrowOptions& options, OptionVisitor& visitor);

/// The learned appearance of a person (section 7): how often hues occur, and lightness for grey colours.
class ColourModel {
 public:
  static constexpr int kHues = 72;   ///< 5 degrees each
  static constexpr int kGreys = 32;  ///< 8 lightness steps each
  static constexpr int kBins = kHues + kGreys;

  /// Returns the bin of a colour: its hue, or its lightness if its saturation is too low for a hue.
  static int bin(Rgb colour);

  void add(int bin) { ++counts_[bin]; }
  /// Returns the number of added pixels.
  long samples() const;
  /// Blurs over the next bin on either side (hues wrap) and normalises; an empty model is uniform.
  void finish();
  float probability(int bin) const { return probabilities_[bin]; }

 private:
  std::array<std::uint32_t, kBins> counts_{};
  std::array<float, kBins> probabilities_{};
};

/// Returns the appearance of the pixels inside `mask`, which has the frame's size; it is empty for a frame without
/// colour.
ColourModel learn_appearance(const Frame& frame, const Mask& mask);

/// Grows people from rough skeletons in one frame (section 7). It clusters pixels by place and colour, beginning with
/// the pixels of the skeleton's proposals, within the body's reach, and never along floor, walls or other people.
class PersonGrower {
 public:
  /// `flat` is 1 on floor, walls and other large flat surfaces. Keeps references: all four must outlive it.
  PersonGrower(const Frame& frame, const Mask& flat, const BodyModel& body, const GrowOptions& options);

  /// Returns the people's masks, 1 inside, one for each skeleton. They grow at the same pace from their own proposals
  /// in `clusters`, so people who touch divide the pixels between them by nearness. `known` is empty, or has each
  /// person's appearance learned before, to which the colours of this frame are added.
  std::vector<Mask> grow(const std::vector<Skeleton>& people, const Clusters& clusters,
                         const std::vector<ColourModel>& known = {}) const;

 private:
  /// Returns 1 on pixels within `radius_m[part]` of each observed part's centre; a radius of 0 reaches nothing.
  Mask around_parts(const Skeleton& rough, const std::vector<float>& radius_m) const;
  /// Returns 1 where a pixel within reach has a colour that the person hardly ever has.
  Mask refused_colours(const Skeleton& rough, const Mask& seeds, const Mask& reach, ColourModel person) const;

  const Frame& frame_;
  const Mask& flat_;
  const BodyModel& body_;
  const GrowOptions& options_;
  std::vector<std::uint8_t> bins_;  ///< ColourModel::bin of every pixel; empty if colour is not used
};

}  // namespace vesalius
