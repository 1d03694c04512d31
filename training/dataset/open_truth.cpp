#include "dataset/open_truth.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "dataset/labelled_dataset.h"
#include "dataset/labelled_folder.h"
#include "dataset/labelled_truth.h"
#include "dataset/truth_folder.h"
#include "io/sources/folder_source.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

class FolderTruth final : public TruthSource {
 public:
  FolderTruth(const std::string& uri, int step) : source_(open_source(uri)), step_(step), truth_(path_of_source(uri)) {}

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

/// The frames of a source with headings of a table.
class HeadedTruth final : public TruthSource {
 public:
  HeadedTruth(std::unique_ptr<TruthSource> frames, HeadingTable headings, std::string set)
      : frames_(std::move(frames)), headings_(std::move(headings)), set_(std::move(set)) {}

  std::optional<TrueFrame> next() override {
    std::optional<TrueFrame> frame = frames_->next();
    if (!frame) return frame;
    if (const auto heading = headings_.of(set_, frame->frame.name)) frame->truth.heading = heading;
    return frame;
  }
  void leave_sequence() override { frames_->leave_sequence(); }
  int size() const override { return frames_->size(); }
  std::vector<std::string> notes() const override { return frames_->notes(); }
  std::vector<std::string> part_names() const override { return frames_->part_names(); }

 private:
  std::unique_ptr<TruthSource> frames_;
  HeadingTable headings_;
  std::string set_;
};

constexpr std::array kTruth{"frames.csv", "joints.csv", "mask", "truth"};

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool has_frames_with_truth(const fs::path& folder) {
  if (is_dataset(folder.string())) return true;
  return is_there(folder / "depth") &&
         std::ranges::any_of(kTruth, [&](const char* name) { return is_there(folder / name); });
}

class JoinedTruth final : public TruthSource {
 public:
  JoinedTruth(std::vector<std::string> folders, std::function<std::unique_ptr<TruthSource>(const std::string&)> open)
      : folders_(std::move(folders)), open_(std::move(open)), source_(open_(folders_.front())) {
    notes_ = source_->notes();
    parts_ = source_->part_names();
  }

  std::optional<TrueFrame> next() override {
    for (;;) {
      if (std::optional<TrueFrame> frame = source_->next()) return renamed(std::move(*frame));
      if (at_ + 1 == folders_.size()) return std::nullopt;
      ++at_;
      source_ = open_(folders_[at_]);
    }
  }
  void leave_sequence() override { source_->leave_sequence(); }
  int size() const override { return -1; }
  std::vector<std::string> notes() const override { return notes_; }
  std::vector<std::string> part_names() const override { return parts_; }

 private:
  TrueFrame renamed(TrueFrame frame) const {
    constexpr int kMostInAFolder = 1 << 20;
    frame.frame.name = fs::path(folders_[at_]).filename().string() + "/" + frame.frame.name;
    if (frame.truth.sequence >= 0) frame.truth.sequence += int(at_) * kMostInAFolder;
    return frame;
  }

  std::vector<std::string> folders_;
  std::function<std::unique_ptr<TruthSource>(const std::string&)> open_;
  std::unique_ptr<TruthSource> source_;
  std::size_t at_ = 0;
  std::vector<std::string> notes_, parts_;
};

/// Returns the folders in `folder` that have frames with truth; if there are none, itself.
std::vector<std::string> sequences_in(const std::string& folder) {
  if (std::vector<std::string> sets = sets_in(folder); sets != std::vector{folder}) return sets;
  std::error_code error;
  if (!fs::is_directory(folder, error) || is_there(fs::path(folder) / "depth") || is_dataset(folder)) return {folder};
  std::vector<std::string> names;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (has_frames_with_truth(it->path())) names.push_back(it->path().filename().string());
  }
  if (names.empty()) return {folder};
  std::ranges::sort(names, natural_less);
  for (std::string& name : names) name = (fs::path(folder) / name).string();
  return names;
}

}  // namespace

std::unique_ptr<TruthSource> open_truth(const std::string& uri, int step) {
  if (step < 1) throw UsageError("every 0th frame, expected a step of at least 1");
  if (is_dataset(uri)) return std::make_unique<LabelledTruth<DatasetReader>>(uri, step);
  if (is_labelled_folder(uri)) return std::make_unique<LabelledTruth<LabelledFolder>>(uri, step);
  return std::make_unique<FolderTruth>(uri, step);
}

std::unique_ptr<TruthSource> open_sequences(
    const std::string& folder, const std::function<std::unique_ptr<TruthSource>(const std::string&)>& open) {
  const std::vector<std::string> folders = sequences_in(folder);
  if (folders.size() == 1) return open(folders.front());
  return std::make_unique<JoinedTruth>(folders, open);
}

std::unique_ptr<TruthSource> with_headings(std::unique_ptr<TruthSource> frames, HeadingTable headings,
                                           std::string set) {
  return std::make_unique<HeadedTruth>(std::move(frames), std::move(headings), std::move(set));
}

}  // namespace vesalius
