#pragma once

#include <memory>
#include <string>
#include <vector>

#include "metrics/score_frame.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// The method with one change.
struct Variant {
  std::string name;
  std::unique_ptr<FrameScorer> scorer;
};

/// Returns the method with one part removed or replaced, for each such part that these options and this forest have:
/// second iteration, colour or depth of the appearance, smoothing, links past an unseen part, each root alone, votes
/// instead of distributions, fewer trees, half resolution (docs/metrics.md, "Ablation"). Changes without effect are
/// left out.
std::vector<Variant> ablation_variants(const Forest& forest, const FrameScorer::Options& options);

}  // namespace vesalius
