#include "dataset/truth_sequences.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "dataset/dataset_folder.h"
#include "dataset/truth_folder.h"
#include "io/sources/folder_source.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

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

std::unique_ptr<TruthSource> joined_truth(std::vector<std::string> folders,
                                          std::function<std::unique_ptr<TruthSource>(const std::string&)> open) {
  return std::make_unique<JoinedTruth>(std::move(folders), std::move(open));
}

std::unique_ptr<TruthSource> open_sequences(
    const std::string& folder, const std::function<std::unique_ptr<TruthSource>(const std::string&)>& open) {
  const std::vector<std::string> folders = sequences_in(folder);
  return folders.size() == 1 ? open(folders.front()) : joined_truth(folders, open);
}

}  // namespace vesalius
