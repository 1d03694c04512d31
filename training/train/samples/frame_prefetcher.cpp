#include "train/samples/frame_prefetcher.h"

#include <algorithm>

namespace vesalius {

FramePrefetcher::FramePrefetcher(const FrameStore& frames, std::span<const TrainingSample> samples)
    : frames_(frames), samples_(samples) {}

void FramePrefetcher::step(std::size_t index) {
  if (index >= frame_end_) enter_frame(index);
  const char* stop = next_ + std::min(bytes_per_sample_, static_cast<std::size_t>(end_ - next_));
  for (; next_ < stop; next_ += kLineBytes) __builtin_prefetch(next_, 0, 2);
}

void FramePrefetcher::enter_frame(std::size_t index) {
  const std::uint32_t frame = samples_[index].frame;
  const auto rest = samples_.subspan(index);
  const auto end = std::ranges::find_if(rest, [&](const TrainingSample& each) { return each.frame != frame; });
  frame_end_ = index + (end - rest.begin());
  next_ = end_ = nullptr;
  bytes_per_sample_ = 0;
  const auto count = double(frame_end_ - index);
  if (end == rest.end()) return;
  const FrameStore::View& view = frames_[end->frame];
  next_ = reinterpret_cast<const char*>(view.depth.row_starts);
  end_ = next_ + view.bytes;
  const std::size_t bytes = static_cast<std::size_t>(double(end_ - next_) / count);
  bytes_per_sample_ = (bytes / kLineBytes + 1) * kLineBytes;
}

}  // namespace vesalius
