#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/find_clusters.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns all people in the proposals, best first. Each proposal belongs to at most one of them. `size` multiplies the
/// lengths of the body's links (above 0): how tall the people are against the body model's.
std::vector<Skeleton> search_skeletons(const std::vector<PartCluster>& clusters, const BodyModel& body,
                                       const SearchOptions& options, float size = 1.F);

}  // namespace vesalius
