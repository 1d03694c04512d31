#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/options.h"
#include "vesalius/find_clusters.h"

namespace vesalius {

struct SearchOptions {
  float max_total_error = 12.F;    ///< largest sum of normalised distances over the parts
  float max_mean_error = 0.6F;     ///< largest mean normalised distance of the parts
  int min_parts = 4;               ///< fewest parts of a person (the paper's threshold)
  float max_error = 1.2F;          ///< pairs of a larger normalised distance are not consistent
  float error_weight = 1.F;        ///< likelihood that a normalised distance of 1 costs; a full part gains 1
  float covariance_share = 0.25F;  ///< share of the parts' own variance along their line that excuses a deviation
  float gap_tolerance_m = 0.08F;   ///< empty space between two linked parts that counts as one unit of error
  bool grandparents = true;        ///< whether an unseen part may be skipped (two degrees of separation); for ablations
  bool any_root = true;  ///< whether a tree may start from any part, or only from the body's roots; for ablations
};
void visit_options(const std::string& prefix, SearchOptions& options, OptionVisitor& visitor);

/// One part of a found person.
struct SkeletonPart {
  State state = State::none;
  int cluster = -1;                                    ///< index of its proposal; -1 unless observed
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();    ///< metres, optical frame
  Eigen::Vector3f extent_m = Eigen::Vector3f::Zero();  ///< standard deviations along its own axes, largest first
  float error = 0.F;       ///< normalised distance to the part to which it is linked; 0 for the root
  float confidence = 0.F;  ///< 0-1
};

/// A kinematic tree over part proposals (section 6).
struct Skeleton {
  std::vector<SkeletonPart> parts;  ///< one for each part of the body model
  int root = -1;                    ///< index of its root
  int found = 0;                    ///< number of observed parts
  float total_error = 0.F;          ///< sum of |normalised distance| over the parts
  float mean_error = 0.F;           ///< total_error / found
  float score = 0.F;                ///< accumulated likelihood; ranks people
};

/// Returns all people in the proposals, best first. Each proposal belongs to at most one of them. `size` multiplies the
/// lengths of the body's links (above 0): how tall the people are against the body model's.
std::vector<Skeleton> search_skeletons(const std::vector<PartCluster>& clusters, const BodyModel& body,
                                       const SearchOptions& options, float size = 1.F);

}  // namespace vesalius
