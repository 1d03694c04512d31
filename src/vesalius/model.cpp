#include "vesalius/model.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <mutex>
#include <utility>

#include "vesalius/cut_out_labeller.h"
#include "vesalius/default_judge.h"
#include "vesalius/error.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/network/network_labeller.h"

namespace vesalius {
namespace {

using SharedLabeller = std::shared_ptr<const Labeller>;

SharedLabeller make_on_processor(Model model) {
  if (model.network == nullptr) return std::make_shared<ForestLabeller>(std::move(model.forest));
  return std::make_shared<NetworkLabeller>(*model.network, model.body.part_count());
}

/// Labels on a device until it fails, from then on on the processor.
class RescuedLabeller : public Labeller {
 public:
  RescuedLabeller(SharedLabeller device, Model model, std::function<void(const std::string&)> note)
      : device_(std::move(device)), model_(std::move(model)), note_(std::move(note)) {}

  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    if (!done([&] { device_->label_into(frame, gate, out); })) processor().label_into(frame, gate, out);
  }
  bool label_and_smooth_into(const Frame& frame, float gate, const SmoothOptions& options, Posteriors& out,
                             Posteriors& smooth) const override {
    bool smoothed = false;
    done([&] { smoothed = device_->label_and_smooth_into(frame, gate, options, out, smooth); });
    return smoothed;
  }
  int smoothing_window() const override { return device_->smoothing_window(); }

 private:
  /// Returns whether the device did the work.
  template <class Work>
  bool done(const Work& work) const {
    if (lost_) return false;
    try {
      work();
      return true;
    } catch (const DeviceError& e) {
      if (!lost_.exchange(true) && note_) note_(std::string(e.what()) + "; the processor goes on");
      return false;
    }
  }

  const Labeller& processor() const {
    std::call_once(once_, [&] { processor_ = make_on_processor(std::move(model_)); });
    return *processor_;
  }

  SharedLabeller device_;
  mutable Model model_;  ///< until the processor takes it
  std::function<void(const std::string&)> note_;
  mutable std::atomic<bool> lost_ = false;
  mutable std::once_flag once_;
  mutable SharedLabeller processor_;
};

SharedLabeller make_on_any(Model model, const LabellerDevices& devices) {
  const auto note = [&](const std::string& text) {
    if (devices.note) devices.note(text);
  };
  if (devices.kinds.empty()) note("this build knows no device but the processor, which labels");
  for (const LabellerDevice& kind : devices.kinds) {
    try {
      SharedLabeller labeller = kind.make(model, 0);
      return std::make_shared<RescuedLabeller>(std::move(labeller), std::move(model), devices.note);
    } catch (const DeviceError& e) {
      note(std::string(e.what()) + "; the processor labels");
    }
  }
  return make_on_processor(std::move(model));
}

}  // namespace

void throw_unknown_device(const std::string& device, const LabellerDevices& devices) {
  std::string known = R"("cpu", "auto")";
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

namespace {

SharedLabeller make_labeller(Model model, const std::string& device, const LabellerDevices& devices) {
  if (device == "cpu") return make_on_processor(std::move(model));
  if (device == "auto") return make_on_any(std::move(model), devices);
  const DeviceName wanted = parse_device(device);
  for (const LabellerDevice& kind : devices.kinds) {
    if (kind.name == wanted.kind) return kind.make(model, wanted.number);
  }
  throw_unknown_device(device, devices);
}

}  // namespace

Model::Model(Forest trained) : body(trained.body), forest(std::move(trained)), headings(std::move(forest.facing)) {
  forest.facing = {};
}

const std::string& labeller_recipe(const Model& model) {
  return model.network != nullptr ? model.network->made_from : model.forest.recipe;
}

void check(const Model& model) {
  if (model.labeller == nullptr && model.network != nullptr) {
    if (!model.forest.trees.empty()) throw Error("model: a forest and a network, expected one of them");
    check(*model.network, model.body.part_count());
  } else if (model.labeller == nullptr) {
    check(model.forest);
    if (!std::ranges::equal(model.body.parts, model.forest.body.parts, {}, &BodyPart::name, &BodyPart::name)) {
      throw Error("body: other parts than the forest's");
    }
    check(model.headings, model.body.part_count(), model.forest.headings);
  }
  check(model.context, "context of bodies");
  check(model.judge, "judge of people");
}

Model on_device(Model model, const std::string& device, const LabellerDevices& devices) {
  check(model);
  if (model.labeller != nullptr) return model;
  const bool background = model.network != nullptr || model.forest.has_background;
  const bool votes = !has_distributions(model.forest);
  Model labelling;
  labelling.body = model.body;
  labelling.forest = std::exchange(model.forest, {});
  labelling.network = std::exchange(model.network, nullptr);
  model.labeller = make_labeller(std::move(labelling), device, devices);
  if (background) return model;
  model.labeller = std::make_shared<CutOutLabeller>(std::move(model.labeller), votes);
  if (model.judge.empty()) model.judge = default_judge_of_cut_outs();
  return model;
}

}  // namespace vesalius
