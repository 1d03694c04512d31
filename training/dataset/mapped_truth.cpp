#include "dataset/mapped_truth.h"

#include <utility>

namespace vesalius {
namespace {

class MappedTruth final : public TruthSource {
 public:
  MappedTruth(std::unique_ptr<TruthSource> frames, std::function<TrueFrame(TrueFrame)> change)
      : frames_(std::move(frames)), change_(std::move(change)) {}

  std::optional<TrueFrame> next() override {
    std::optional<TrueFrame> frame = frames_->next();
    return frame ? std::optional(change_(std::move(*frame))) : std::nullopt;
  }
  void leave_sequence() override { frames_->leave_sequence(); }
  int size() const override { return frames_->size(); }
  std::vector<std::string> notes() const override { return frames_->notes(); }
  std::vector<std::string> part_names() const override { return frames_->part_names(); }

 private:
  std::unique_ptr<TruthSource> frames_;
  std::function<TrueFrame(TrueFrame)> change_;
};

}  // namespace

std::unique_ptr<TruthSource> mapped(std::unique_ptr<TruthSource> frames, std::function<TrueFrame(TrueFrame)> change) {
  return std::make_unique<MappedTruth>(std::move(frames), std::move(change));
}

}  // namespace vesalius
