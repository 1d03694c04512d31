#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "train/messages/training_sample.h"
#include "train/samples/frame_store.h"
#include "vesalius/forest.h"

namespace vesalius {

/// Returns [tree][sample]: the index of the leaf that each sample reaches, as `leaf_of` finds it. The trees' `leaves`
/// may be empty. Samples are ordered by frame; those of frames that are not wanted get 0.
std::vector<std::vector<std::uint32_t>> find_leaves(
    const std::vector<const Tree*>& trees, const FrameStore& frames, std::span<const TrainingSample> samples,
    const std::function<bool(std::uint32_t)>& wanted = [](std::uint32_t /*frame*/) { return true; });

}  // namespace vesalius
