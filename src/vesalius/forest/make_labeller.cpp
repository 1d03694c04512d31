#include "vesalius/forest/make_labeller.h"

#include <atomic>
#include <charconv>
#include <mutex>
#include <utility>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

using Labeller = std::shared_ptr<const PixelLabeller>;

/// Labels on a device until it fails, from then on on the processor.
class RescuedLabeller : public PixelLabeller {
 public:
  RescuedLabeller(Labeller device, Forest forest, std::function<void(const std::string&)> note)
      : device_(std::move(device)), forest_(std::move(forest)), note_(std::move(note)) {}

  void label_into(const DepthImage& depth, const Camera& camera, float gate, Posteriors& out) const override {
    if (!on_device([&] { device_->label_into(depth, camera, gate, out); })) {
      processor().label_into(depth, camera, gate, out);
    }
  }
  bool label_and_smooth_into(const DepthImage& depth, const Camera& camera, float gate, const SmoothOptions& options,
                             Posteriors& out, Posteriors& smooth) const override {
    bool done = false;
    on_device([&] { done = device_->label_and_smooth_into(depth, camera, gate, options, out, smooth); });
    return done;
  }
  // What the forest says is known without the device.
  const BodyModel& body() const override { return device_->body(); }
  bool has_background() const override { return device_->has_background(); }
  bool has_distributions() const override { return device_->has_distributions(); }
  const FacingModel& facing_model() const override { return device_->facing_model(); }
  const BoostedTrees& context() const override { return device_->context(); }
  const BoostedTrees& judge() const override { return device_->judge(); }

 private:
  /// Returns whether the device did the work.
  template <class Work>
  bool on_device(const Work& work) const {
    if (lost_) return false;
    try {
      work();
      return true;
    } catch (const DeviceError& e) {
      if (!lost_.exchange(true) && note_) note_(std::string(e.what()) + "; the processor goes on");
      return false;
    }
  }

  const PixelLabeller& processor() const {
    std::call_once(once_, [&] { processor_ = std::make_unique<ForestLabeller>(std::move(forest_)); });
    return *processor_;
  }

  Labeller device_;
  mutable Forest forest_;  ///< until the processor takes it
  std::function<void(const std::string&)> note_;
  mutable std::atomic<bool> lost_ = false;
  mutable std::once_flag once_;
  mutable std::unique_ptr<const ForestLabeller> processor_;
};

Labeller make_on_any(Forest forest, const LabellerDevices& devices) {
  const auto note = [&](const std::string& text) {
    if (devices.note) devices.note(text);
  };
  if (devices.kinds.empty()) note("this build knows no device but the processor, which labels");
  for (const LabellerDevice& kind : devices.kinds) {
    try {
      Labeller labeller = kind.make(forest, 0);
      return std::make_shared<RescuedLabeller>(std::move(labeller), std::move(forest), devices.note);
    } catch (const DeviceError& e) {
      note(std::string(e.what()) + "; the processor labels");
    }
  }
  return std::make_shared<ForestLabeller>(std::move(forest));
}

}  // namespace

void throw_unknown_device(const std::string& device, const LabellerDevices& devices) {
  std::string known = "\"cpu\", \"auto\"";
  for (const LabellerDevice& kind : devices.kinds) known += ", \"" + kind.name + "\" or \"" + kind.name + ":NUMBER\"";
  throw UsageError("device \"" + device + "\" is not known to this build, expected " + known);
}

DeviceName parse_device(const std::string& name) {
  const std::size_t colon = name.find(':');
  DeviceName parsed{name.substr(0, colon), 0};
  if (colon == std::string::npos) return parsed;
  const char* end = name.data() + name.size();
  const auto [read, error] = std::from_chars(name.data() + colon + 1, end, parsed.number);
  return error == std::errc{} && read == end && parsed.number >= 0 ? parsed : DeviceName{};
}

Labeller make_labeller(Forest forest, const std::string& device, const LabellerDevices& devices) {
  if (device == "cpu") return std::make_shared<ForestLabeller>(std::move(forest));
  if (device == "auto") return make_on_any(std::move(forest), devices);
  const DeviceName wanted = parse_device(device);
  for (const LabellerDevice& kind : devices.kinds) {
    if (kind.name == wanted.kind) return kind.make(std::move(forest), wanted.number);
  }
  throw_unknown_device(device, devices);
}

}  // namespace vesalius
