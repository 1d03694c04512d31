#pragma once

#include <memory>
#include <string>
#include <vector>

#include "eval/score_frame.h"
#include "vesalius/forest/forest.h"

namespace vesalius::cli {

/// The method with one thing changed.
struct Variant {
  std::string name;
  std::unique_ptr<FrameScorer> scorer;
};

/// What can be taken away from the method, or done otherwise, given these options and this forest: second iteration,
/// colour or depth alone for the person's look, smoothing, links past an unseen part, each root alone, votes instead of
/// distributions, fewer trees, half resolution. Changes that would change nothing are left out.
std::vector<Variant> ablation_variants(const Forest& forest, const DetectOptions& options);

}  // namespace vesalius::cli
