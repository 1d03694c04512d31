#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dataset/truth_source.h"
#include "io/sources/source_options.h"
#include "vesalius/base/body_model.h"

namespace vesalius {

/// Opens frames with their truth: a labelled dataset or a labelled folder (LabelledExporter) with the parts' centres as
/// joints, under the parts' names; depth maps of ITOP (truth_itop.h); or any source that `open_source` opens and that
/// TruthFolder knows something about. Gives out the first of every `step` frames. Throws Error as those do.
std::unique_ptr<TruthSource> open_truth(const std::string& uri, int step = 1, const SourceOptions& options = {});

/// Returns a labelled frame as truth: joints are the parts' centres, under the parts' names.
TrueFrame as_true_frame(LabelledFrame labelled, const std::vector<std::string>& part_names);

/// Returns the names of a body's parts, in order.
std::vector<std::string> part_names_of(const BodyModel& body);

}  // namespace vesalius
