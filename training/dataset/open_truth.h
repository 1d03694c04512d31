#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dataset/truth_csv.h"
#include "metrics/frame_truth.h"

namespace vesalius {

/// A sequence of frames with their truth.
class TruthSource {
 public:
  virtual ~TruthSource() = default;
  /// Returns the next frame, or nothing at the end. Throws Error if the frame cannot be read; the next call then
  /// continues after it.
  virtual std::optional<TrueFrame> next() = 0;
  /// Says that no more frames are wanted of the recording (FrameTruth::sequence) that the last one belongs to. A source
  /// may leave those out where that is quicker than to read them, and may as well give them.
  virtual void leave_sequence() {}
  /// Returns the total number of frames, or -1 if it is not known.
  virtual int size() const = 0;
  /// Returns remarks for the user, one line each.
  virtual std::vector<std::string> notes() const { return {}; }
  /// Returns the names of the parts; labels are indices into them. The list is empty if there are no labels.
  virtual std::vector<std::string> part_names() const { return {}; }
};

/// Opens frames with their truth: a labelled dataset, a folder of labelled frames (LabelledExporter), or any other
/// source that `open_source` opens and TruthFolder has truth for. Gives the first of every `step` frames. Throws Error
/// as those readers do.
std::unique_ptr<TruthSource> open_truth(const std::string& uri, int step = 1);

/// Returns the frames of all folders in `folder` that have frames with truth, those of one after those of the other in
/// the order of their names: of the folders that its own frames.csv names (sets_in), or else those with depth/ and
/// frames.csv, joints.csv or mask/ in them and labelled datasets. Each is opened by `open` when it is its turn. What is
/// a recording in one (FrameTruth::sequence) is one here, with another number; names of frames begin with that of their
/// folder. If `folder` itself holds frames or is none or has no such folders, it is opened as it is. Throws Error as
/// the sources do, of which the first is opened now.
std::unique_ptr<TruthSource> open_sequences(
    const std::string& folder, const std::function<std::unique_ptr<TruthSource>(const std::string&)>& open);

/// Returns the same frames with the headings that the table has for the set; others keep their own.
std::unique_ptr<TruthSource> with_headings(std::unique_ptr<TruthSource> frames, HeadingTable headings, std::string set);

}  // namespace vesalius
