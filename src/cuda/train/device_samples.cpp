#include "cuda/train/device_samples.h"

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

DeviceFrames::DeviceFrames(const FrameStore& frames, std::shared_ptr<Device> device)
    : device_(std::move(device)), convention_(frames.convention()) {
  std::vector<FrameInfo> infos;
  std::uint64_t words = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const Camera& camera = frames.camera(f);
    const OffsetScaler& scaler = frames[f].scaler;
    infos.push_back({words, camera.width, camera.height, scaler.unit_u(), scaler.unit_v()});
    words += frames.words(f).size();
  }
  const TrainStream stream(device_);
  words_ = DeviceArray<std::uint32_t>(device_, words);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::span<const std::uint32_t> of_frame = frames.words(f);
    stream->copy_to_device(words_.data() + infos[f].word, of_frame.data(), of_frame.size_bytes());
  }
  stream.send(infos_, infos);
  stream->wait();
}

TiledFrames DeviceFrames::describe() const {
  return {words_.data(), infos_.data(), convention_.hole_mm, convention_.outside_mm, convention_.clip_mm};
}

DeviceSamples::DeviceSamples(const TrainingSet& set, std::shared_ptr<const DeviceFrames> frames)
    : frames_(std::move(frames)), count_(static_cast<std::uint32_t>(set.samples().size())) {
  const TrainStream stream(device());
  stream.fit(pixels_, count_);
  stream.fit(scales_, count_);
  if (count_ > 0) stream->copy_to_device(pixels_.data(), set.samples().data(), set.samples().size_bytes());
  stream.launch(ScaleArguments{this->frames(), describe(), scales_.data()}, count_);
  stream->wait();
}

}  // namespace vesalius::gpu
