#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/appearance.h"
#include "vesalius/find_clusters.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"

namespace vesalius {

/// Grows people from rough skeletons in one frame (section 7). It clusters pixels by place and look, beginning with
/// the pixels of the skeleton's proposals, within the body's reach, and never along floor, walls or other people.
class PersonGrower {
 public:
  /// `flat` is 1 on floor, walls and other large flat surfaces. Without an appearance people grow by depth alone. Keeps
  /// references: all five must outlive it.
  PersonGrower(const Frame& frame, const Mask& flat, const BodyModel& body, const GrowOptions& options,
               const Looks& looks);

  /// Returns the people's masks, 1 inside, one for each skeleton. They grow at the same pace from their own proposals
  /// in `clusters`, so people who touch divide the pixels between them by nearness. `known` is empty, or has each
  /// person's appearance learned before, to which the looks of this frame are added.
  std::vector<Mask> grow(const std::vector<Skeleton>& people, const Clusters& clusters,
                         const std::vector<AppearanceHistogram>& known = {}) const;
  /// Pixels to which somebody may grow.
  struct Reach {
    Mask pixels;
    Box box;  ///< around them
  };
  Reach reach_of(const Skeleton& rough) const;
  /// Does the same for one person whose reach is known, faster where all clusters lie within a box.
  Mask grow(const Skeleton& person, Reach reach, const Clusters& clusters, const Box& within) const;

 private:
  std::vector<Mask> grow(const std::vector<Skeleton>& people, std::vector<Reach> reaches, const Clusters& clusters,
                         const std::vector<AppearanceHistogram>& known, const Box& within) const;
  /// Returns the pixels within `radius_m[part]` of each observed part's centre; a radius of 0 reaches nothing.
  Reach around_parts(const Skeleton& rough, const std::vector<float>& radius_m) const;
  /// Takes from `allowed`, the pixels within reach, those that look as the person hardly ever does. All seeds and
  /// allowed pixels are in `box`.
  void refuse_looks(const Skeleton& rough, const Mask& seeds, const Box& box, AppearanceHistogram person,
                    Mask& allowed) const;

  const Frame& frame_;
  const Mask& flat_;
  const BodyModel& body_;
  const GrowOptions& options_;
  const Looks& looks_;
};

}  // namespace vesalius
