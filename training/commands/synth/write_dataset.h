#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <utility>

#include "commands/synth/frame_maker.h"
#include "commands/synth/synth_assets.h"
#include "console/interrupts.h"
#include "console/progress.h"
#include "dataset/labelled_dataset.h"
#include "train/parallel_in_order.h"
#include "vesalius/error.h"

namespace vesalius::cli {

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
