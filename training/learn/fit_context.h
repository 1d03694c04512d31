#pragma once

#include "learn/boost_trees.h"

namespace vesalius {

/// How the trees of a forest's context of bodies are grown: neighbouring cells are alike, so leaves are large.
inline constexpr BoostOptions kContextOptions{
    .trees = 120, .rate = 0.1, .sample_share = 0.6, .feature_share = 0.4, .ridge = 10.0, .least_samples = 200};

/// Bodies' odds are so many times those that the samples have. A label is the background where that is likelier than
/// any single part, and a body's pixel has several likely parts; so the weights of the background stay what they are
/// for forests without context (docs/decisions/0037).
inline constexpr double kContextOdds = 7.0;

}  // namespace vesalius
