#include "cuda_train/device_samples.h"

#include <algorithm>
#include <utility>

namespace vesalius::gpu {
namespace {

static_assert(sizeof(SamplePixel) == sizeof(TrainingSample) &&
                  offsetof(SamplePixel, depth_mm) == offsetof(TrainingSample, depth_mm) &&
                  offsetof(SamplePixel, label) == offsetof(TrainingSample, label) &&
                  offsetof(SamplePixel, heading) == offsetof(TrainingSample, heading),
              "samples are sent as they are");

}  // namespace

DeviceFrames::DeviceFrames(const FrameStore& frames, std::uint32_t first, std::uint32_t end,
                           std::shared_ptr<Device> device)
    : device_(std::move(device)), convention_(frames.convention()), first_(first), end_(end) {
  std::vector<FrameInfo> infos;
  std::uint64_t words = 0;
  for (std::uint32_t f = first; f < end; ++f) {
    const Camera& camera = frames.camera(f);
    const OffsetScaler& scaler = frames[f].scaler;
    infos.push_back({words, camera.width, camera.height, scaler.unit_u(), scaler.unit_v()});
    words += frames.words(f).size();
  }
  const TrainStream stream(device_);
  words_ = DeviceArray<std::uint32_t>(device_, words);
  for (std::uint32_t f = first; f < end; ++f) {
    const std::span<const std::uint32_t> of_frame = frames.words(f);
    stream->copy_to_device(words_.data() + infos[f - first].word, of_frame.data(), of_frame.size_bytes());
  }
  stream.send(infos_, infos);
  stream->wait();
}

TiledFrames DeviceFrames::describe() const {
  return {words_.data(), infos_.data(), first_, convention_.hole_mm, convention_.outside_mm, convention_.clip_mm};
}

DeviceSamples::DeviceSamples(const TrainingSet& set, std::shared_ptr<const DeviceFrames> frames, bool leads)
    : set_(set), frames_(std::move(frames)), leads_(leads) {
  const auto from = [&](std::uint32_t frame) {
    return std::ranges::lower_bound(set.samples(), frame, {}, &TrainingSample::frame);
  };
  samples_ = {from(frames_->first()), from(frames_->end())};
  const TrainStream stream(device());
  stream.fit(pixels_, samples_.size());
  stream.fit(scales_, samples_.size());
  if (!samples_.empty()) stream->copy_to_device(pixels_.data(), samples_.data(), samples_.size_bytes());
  stream.launch(ScaleArguments{this->frames(), describe(), scales_.data()}, samples_.size());
  stream->wait();
}

SampleCounts DeviceSamples::sample_counts() const {
  SampleCounts counts = set_.sample_counts();
  if (leads_) return counts;
  std::ranges::fill(counts.samples, 0);
  std::ranges::fill(counts.pixels, 0U);
  return counts;
}

}  // namespace vesalius::gpu
