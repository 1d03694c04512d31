#pragma once

#include <cstddef>
#include <span>

#include "train/messages/training_sample.h"
#include "train/samples/frame_store.h"

namespace vesalius {

/// Prefetches the next frame's depth, a few cache lines with every sample of the current frame, because unpacking it
/// would otherwise wait for memory. Results do not depend on it.
class FramePrefetcher {
 public:
  FramePrefetcher(const FrameStore& frames, std::span<const TrainingSample> samples);

  /// Prefetches; called before sample `index` is read. Indices increase by one.
  void step(std::size_t index);

 private:
  void enter_frame(std::size_t index);

  const FrameStore& frames_;
  std::span<const TrainingSample> samples_;
  std::size_t frame_end_ = 0;  ///< first sample of the next frame
  const char* next_ = nullptr;
  const char* end_ = nullptr;
  std::size_t bytes_per_sample_ = 0;
};

}  // namespace vesalius
