#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/base/frame_source.h"

namespace vesalius {

/// Of every `step` frames of a source the first.
class SteppedSource {
 public:
  /// A frame and how many came before it in the source.
  struct Step {
    Frame frame;
    int index = 0;
  };

  /// `step` of at least 1.
  SteppedSource(std::unique_ptr<FrameSource> source, int step) : source_(std::move(source)), step_(step) {}

  /// Nothing after the last one. Throws Error as the source does.
  std::optional<Step> next() {
    for (;;) {
      const int index = passed_++;
      std::optional<Frame> frame = source_->next();
      if (!frame) return std::nullopt;
      if (index % step_ == 0) return Step{std::move(*frame), index};
    }
  }
  /// Frames in all; negative where the source does not know.
  int size() const {
    const int all = source_->size();
    return all < 0 ? all : (all + step_ - 1) / step_;
  }
  std::vector<std::string> notes() const { return source_->notes(); }

 private:
  std::unique_ptr<FrameSource> source_;
  int step_;
  int passed_ = 0;
};

}  // namespace vesalius
