#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/sources/open_source.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/frame_truth.h"

namespace vesalius {

/// Frames with their truth, one after the other.
class TruthSource {
 public:
  virtual ~TruthSource() = default;
  /// The next frame, or nothing at the end. Throws Error for one that cannot be read; the next call passes over it.
  virtual std::optional<TrueFrame> next() = 0;
  /// Number of frames in all, -1 where not known.
  virtual int size() const = 0;
  virtual std::vector<std::string> notes() const { return {}; }
  /// Names of the parts that labels are numbers of; empty where there are no labels.
  virtual std::vector<std::string> part_names() const { return {}; }
};

/// Opens a labelled dataset (joints: the parts' centres, under the parts' names), depth maps of ITOP (truth_itop.h), or
/// any folder that `open_source` opens and that TruthFolder knows something about. Of every `step` frames the first is
/// given out. Throws Error as those do.
std::unique_ptr<TruthSource> open_truth(const std::string& uri, int step = 1, const SourceOptions& options = {});

/// A labelled frame as truth: joints are the parts' centres, under the parts' names.
TrueFrame as_true_frame(LabelledFrame labelled, const std::vector<std::string>& part_names);

/// Names of a body's parts, in order.
std::vector<std::string> part_names_of(const BodyModel& body);

}  // namespace vesalius
