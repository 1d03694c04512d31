#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "cli/synth/synth_assets.h"
#include "dataset/truth_source.h"
#include "vesalius/base/body_model.h"

namespace vesalius::cli {

/// Frames to be rendered from a recipe while they are measured on; none is kept.
struct RenderedTruth {
  int count = 0;           ///< frames
  std::uint64_t seed = 1;  ///< as of `vesalius synth`
  AssetPlaces assets;
};

/// The frames that `vesalius synth --recipe FILE --count N --seed S` would write, of every `step` the first, with the
/// labels of `body`. Renders some frames at a time on all threads allowed. Its notes say
/// which assets the frames are made from, so that two evaluations can be told to have seen the same. Throws as
/// make_recipe and load_assets do.
std::unique_ptr<TruthSource> open_recipe_truth(const std::string& recipe_file, const RenderedTruth& rendered, int step,
                                               const BodyModel& body);

}  // namespace vesalius::cli
