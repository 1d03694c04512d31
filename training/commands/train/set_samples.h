#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dataset/open_truth.h"
#include "metrics/fit_samples.h"
#include "vesalius/model.h"

namespace vesalius::cli {

/// Returns the samples of a frame. Any thread may call it.
using SampleFrame = std::function<std::vector<BoostSample>(const TrueFrame&)>;

/// Samples for a context of bodies, by what the model says before there is one (context_samples).
SampleFrame context_sampler(const Model& model);
/// Samples for a judge: what the detector proposes with its default options (judge_samples).
SampleFrame judge_sampler(const Model& model);

/// Returns the samples of all frames in their order, found on all allowed threads; `done` hears of each frame. Throws
/// Error as the source does, and when the user interrupts.
std::vector<BoostSample> samples_of(TruthSource& frames, const SampleFrame& sample, const std::function<void()>& done);

/// Writes samples atomically with a text that says what they were made from. Throws Error if they cannot be written.
void write_samples(const std::string& path, const std::string& made_from, const std::vector<BoostSample>& samples);
/// Returns samples that were made from that; nothing where the file is missing, damaged or made from something else.
std::optional<std::vector<BoostSample>> read_samples(const std::string& path, const std::string& made_from);

}  // namespace vesalius::cli
