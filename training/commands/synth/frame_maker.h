#pragma once

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <utility>

#include "commands/synth/synth_recipe.h"
#include "console/interrupts.h"
#include "console/status_line.h"
#include "dataset/labelled_dataset.h"
#include "synth/generate.h"
#include "synth/recipe.h"
#include "train/parallel_in_order.h"
#include "vesalius/body_model.h"
#include "vesalius/error.h"
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

/// Makes the frames of a range in order. `prepare` runs on all threads, `take` in the calling one. Throws Error when
/// the user interrupts.
template <class Prepare, class Take>
void make_frames(const FrameMaker& maker, std::uint64_t first, int count, Progress& progress, const Prepare& prepare,
                 const Take& take) {
  parallel_in_order(
      count,
      [&](int i) {
        const std::uint64_t index = first + i;
        return prepare(index, maker.frame(index));
      },
      [&](int i, auto item) {
        if (interrupted()) return false;
        take(first + i, std::move(item));
        progress.step();
        return true;
      });
  if (interrupted()) throw Error(fmt::format("interrupted after {} frames", progress.done()));
}

/// Describes the dataset of so many frames of a recipe; they stand alone.
DatasetInfo rendered_info(const synth::Recipe& recipe, const LoadedAssets& loaded, const BodyModel& body,
                          std::uint64_t seed, std::uint64_t frames);

/// Renders the shards that the dataset in `folder` lacks. Throws Error as DatasetWriter does, and when the user
/// interrupts.
void write_dataset(const std::string& folder, const FrameMaker& maker, const DatasetInfo& info, bool shown);

}  // namespace vesalius::cli
