#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "commands/synth/synth_assets.h"
#include "dataset/labelled_dataset.h"
#include "synth/clip_generator.h"
#include "synth/recipe.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"

namespace vesalius::cli {

/// The length of clips in seconds and their rate; neither is given for frames that stand alone.
struct ClipRequest {
  std::optional<float> clip_s;
  std::optional<double> rate_hz;
};

/// Throws UsageError for a clip that is too short or long.
synth::ClipTiming timing_of(const ClipRequest& clips);

/// The frames of a recipe by their numbers; those of clips come one clip after the other.
struct FrameMaker {
  std::function<LabelledFrame(std::uint64_t index)> frame;  ///< any thread may call it
  ClipLayout clips;

  /// Returns how many frames there are in so many frames or clips.
  std::uint64_t frames_in(std::uint64_t count) const {
    return clips.frames_per_clip == 0 ? count : count * clips.frames_per_clip;
  }
};

/// Throws UsageError as timing_of does.
FrameMaker make_frame_maker(const synth::Recipe& recipe, synth::BodiesAndMotions assets, const BodyModel& body,
                            std::uint64_t seed, const ClipRequest& clips);

}  // namespace vesalius::cli
