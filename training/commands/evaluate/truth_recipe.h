#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "commands/synth/synth_recipe.h"
#include "dataset/open_truth.h"
#include "synth/generate.h"
#include "vesalius/body_model.h"

namespace vesalius::cli {

/// Frames that are rendered from a recipe while they are evaluated. No frame is kept.
struct RenderedTruth {
  int count = 0;           ///< frames, or clips
  std::uint64_t seed = 1;  ///< the seed of `vesalius synth`
  AssetPlaces assets;
  std::optional<synth::ClipTiming> clip = std::nullopt;  ///< clips instead of single frames
};

/// Opens the frames that `vesalius synth --recipe FILE --count N --seed S` would write (with --clip and --rate those of
/// clips), with the labels of `body`, and gives the first of every `step`. Several frames are rendered at a time on all
/// allowed threads. The notes name the assets from which frames are made, so that one can tell whether two evaluations
/// saw the same frames. Throws as make_recipe and load_assets do.
std::unique_ptr<TruthSource> open_recipe_truth(const std::string& recipe_file, const RenderedTruth& rendered, int step,
                                               const BodyModel& body);

}  // namespace vesalius::cli
