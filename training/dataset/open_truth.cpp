#include "dataset/open_truth.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "dataset/labelled_dataset.h"
#include "dataset/labelled_folder.h"
#include "dataset/skeleton_truth.h"
#include "dataset/truth_folder.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

class FolderTruth final : public TruthSource {
 public:
  FolderTruth(const std::string& uri, int step, const SourceOptions& options)
      : source_(open_source(uri, options)), step_(step), truth_(path_of_source(uri)) {}

  std::optional<TrueFrame> next() override {
    if (left_) return std::nullopt;
    std::optional<Frame> frame = next_frame();
    if (!frame) return std::nullopt;
    FrameTruth truth = truth_.truth_of(*frame);
    frame->time_s = truth_.time_of(*frame);
    return TrueFrame{std::move(*frame), std::move(truth)};
  }
  void leave_sequence() override { left_ = true; }
  int size() const override {
    const int all = source_->size();
    return all < 0 ? all : (all + step_ - 1) / step_;
  }
  std::vector<std::string> notes() const override { return source_->notes(); }

 private:
  /// Returns the next of every `step` frames.
  std::optional<Frame> next_frame() {
    for (;;) {
      const int index = passed_++;  // a frame that cannot be read counts as well
      std::optional<Frame> frame = source_->next();
      if (!frame || index % step_ == 0) return frame;
    }
  }

  bool left_ = false;
  std::unique_ptr<FrameSource> source_;
  int step_;
  int passed_ = 0;
  TruthFolder truth_;
};

const std::vector<std::string>& joints_of(const DatasetReader& reader) { return reader.info().joints; }
const std::vector<std::string>& joints_of(const LabelledFolder& folder) { return folder.joint_names(); }

int clip_in(const DatasetReader& reader, std::uint64_t index) { return reader.info().clips.clip_of(index); }
int clip_in(const LabelledFolder& folder, std::uint64_t index) { return folder.clips().clip_of(index); }

/// Returns how many of the people are in the picture.
int people_seen(const Image<std::uint8_t>& person, std::size_t people) {
  std::vector<bool> seen(kBackground + 1, false);
  for (const std::uint8_t who : person) seen[who] = true;
  return int(std::count(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(people), true));
}

/// Gives the frames of a DatasetReader or LabelledFolder as truth.
template <class Reader>
class LabelledTruth final : public TruthSource {
 public:
  LabelledTruth(const std::string& folder, int step) : reader_(folder), step_(step) {
    if (reader_.size() > std::numeric_limits<int>::max()) throw Error(folder + ": more frames than can be counted");
  }

  std::optional<TrueFrame> next() override {
    if (next_ >= reader_.size()) return std::nullopt;
    const std::uint64_t index = std::exchange(next_, next_ + step_);
    return as_true_frame(reader_.read(index), joints_of(reader_), clip_in(reader_, index));
  }
  int size() const override { return int((reader_.size() + step_ - 1) / step_); }
  std::vector<std::string> part_names() const override { return part_names_of(reader_.body()); }

 private:
  Reader reader_;
  std::uint64_t step_;
  std::uint64_t next_ = 0;
};

}  // namespace

TrueFrame as_true_frame(LabelledFrame labelled, const std::vector<std::string>& joint_names, int clip) {
  TrueFrame result;
  FrameTruth& truth = result.truth;
  truth.people = int(labelled.parts.size());
  truth.sequence = clip;
  if (clip >= 0) {
    truth.ids.resize(labelled.parts.size());
    std::iota(truth.ids.begin(), truth.ids.end(), 0);
    truth.people = people_seen(labelled.person, labelled.parts.size());
  }
  truth.mask = Mask(labelled.person.width(), labelled.person.height(), 0);
  for (std::size_t i = 0; i < truth.mask.size(); ++i) truth.mask[i] = labelled.person[i] == kBackground ? 0 : 1;
  add_skeleton_truth(joint_names, labelled.joints, truth);
  truth.parts = std::move(labelled.parts);
  truth.postures = std::move(labelled.postures);
  truth.up = labelled.up;
  truth.camera_height_m = labelled.camera_height_m;
  truth.person = std::move(labelled.person);
  truth.labels = std::move(labelled.labels);
  result.frame = std::move(labelled.frame);
  return result;
}

std::vector<std::string> part_names_of(const BodyModel& body) {
  std::vector<std::string> names;
  for (const BodyPart& part : body.parts) names.push_back(part.name);
  return names;
}

std::unique_ptr<TruthSource> open_truth(const std::string& uri, int step, const SourceOptions& options) {
  if (step < 1) throw UsageError("every 0th frame, expected a step of at least 1");
  if (is_dataset(uri)) return std::make_unique<LabelledTruth<DatasetReader>>(uri, step);
  if (is_labelled_folder(uri)) return std::make_unique<LabelledTruth<LabelledFolder>>(uri, step);
  return std::make_unique<FolderTruth>(uri, step, options);
}

}  // namespace vesalius
