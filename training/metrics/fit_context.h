#pragma once

#include <memory>
#include <vector>

#include "metrics/boost_trees.h"
#include "vesalius/base/frame_truth.h"
#include "vesalius/detect.h"

namespace vesalius {

/// How the trees of a forest's context of bodies are grown: neighbouring cells are alike, so leaves are large.
inline constexpr BoostOptions kContextOptions{
    .trees = 120, .rate = 0.1, .sample_share = 0.6, .feature_share = 0.4, .ridge = 10.0, .least_samples = 200};

/// Bodies' odds are so many times those that the samples have. A label is the background where that is likelier than
/// any single part, and a body's pixel has several likely parts; so the weights of the background stay what they are
/// for forests without context (docs/decisions/0037).
inline constexpr double kContextOdds = 7.0;

/// Returns one of every kContextEvery cells of a frame that may be bodies (body_context.h), as the detector sees them,
/// and whether they are. The labeller has a background class. Frames whose labels are not known have none. The same
/// frame gives the same cells.
std::vector<BoostSample> context_samples(const TrueFrame& frame, const std::shared_ptr<const PixelLabeller>& labeller,
                                         const DetectOptions& options);
inline constexpr unsigned kContextEvery = 48;

}  // namespace vesalius
