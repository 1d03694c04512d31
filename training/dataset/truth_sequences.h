#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "dataset/truth_source.h"

namespace vesalius {

/// Returns the folders in `folder` that have frames with truth, in the order of their names: those that its own
/// frames.csv names (sets_in), or else those with depth/ and frames.csv, joints.csv or mask/ in them and
/// labelled datasets. If `folder` itself holds frames or is none or has no such folders, it is the only one.
std::vector<std::string> sequences_in(const std::string& folder);

/// Returns the frames of several sources as one, those of one after those of the other. Each source is opened by `open`
/// when it is its turn. What is a recording in a source (FrameTruth::sequence) is one here, with another number; names
/// of frames begin with that of their folder. Throws Error as the sources do, of which the first is opened now.
std::unique_ptr<TruthSource> joined_truth(std::vector<std::string> folders,
                                          std::function<std::unique_ptr<TruthSource>(const std::string&)> open);

/// Returns the frames of all sequences_in a folder; where that is one, it is opened as it is.
std::unique_ptr<TruthSource> open_sequences(
    const std::string& folder, const std::function<std::unique_ptr<TruthSource>(const std::string&)>& open);

}  // namespace vesalius
