#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Gives the first of every `step` frames of a source.
class SteppedSource {
 public:
  /// A frame and its index in the source.
  struct Step {
    Frame frame;
    int index = 0;
  };

  /// `step` must be at least 1.
  SteppedSource(std::unique_ptr<FrameSource> source, int step) : source_(std::move(source)), step_(step) {}

  /// Returns the next frame, or nothing after the last one. Throws Error as the source does.
  std::optional<Step> next() {
    for (;;) {
      const int index = passed_++;
      std::optional<Frame> frame = source_->next();
      if (!frame) return std::nullopt;
      if (index % step_ == 0) return Step{std::move(*frame), index};
    }
  }
  /// Returns the number of frames; it is negative if the source does not know its own.
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
