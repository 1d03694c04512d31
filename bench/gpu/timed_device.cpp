#include "bench/gpu/timed_device.h"

#include <algorithm>
#include <functional>

namespace vesalius::gpu {

class TimedDevice::TimedStream : public Stream {
 public:
  TimedStream(std::shared_ptr<TimedDevice> device, std::unique_ptr<Stream> stream)
      : device_(std::move(device)), stream_(std::move(stream)) {}

  void copy_to_device(void* to, const void* from, std::size_t bytes) override {
    timed("copies there", [&] { stream_->copy_to_device(to, from, bytes); });
  }
  void copy_to_host(void* to, const void* from, std::size_t bytes) override {
    timed("copies back", [&] { stream_->copy_to_host(to, from, bytes); });
  }
  void clear(void* at, std::size_t bytes) override {
    timed("clear", [&] { stream_->clear(at, bytes); });
  }
  void launch(const KernelCall& call, const LaunchShape& shape) override {
    timed(call.name(), [&] { stream_->launch(call, shape); });
  }
  void record(Event& event) override { stream_->record(event); }
  void wait() override {
    stream_->wait();
    for (const Work& work : work_) {
      auto found = std::ranges::find(device_->times_, work.name, &std::pair<std::string, double>::first);
      if (found == device_->times_.end()) found = device_->times_.insert(found, {work.name, 0.0});
      found->second += work.end->ms_since(*work.begin);
    }
    work_.clear();
  }

 private:
  struct Work {
    std::string name;
    std::unique_ptr<Event> begin, end;
  };

  void timed(const std::string& name, const std::function<void()>& start) {
    Work work{name, device_->make_event(), device_->make_event()};
    stream_->record(*work.begin);
    start();
    stream_->record(*work.end);
    work_.push_back(std::move(work));
  }

  std::shared_ptr<TimedDevice> device_;
  std::unique_ptr<Stream> stream_;
  std::vector<Work> work_;
};

std::unique_ptr<Stream> TimedDevice::make_stream() {
  return std::make_unique<TimedStream>(shared_from_this(), device_->make_stream());
}

std::vector<std::pair<std::string, double>> TimedDevice::take_times() { return std::exchange(times_, {}); }

}  // namespace vesalius::gpu
