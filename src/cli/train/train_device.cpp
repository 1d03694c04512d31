#include "cli/train/train_device.h"

#include <sstream>
#include <utility>

#include "cli/text_sink.h"
#include "train/local_executor.h"
#include "vesalius/base/error.h"
#include "vesalius/forest/make_labeller.h"

namespace vesalius::cli {

namespace {

/// The devices that a list like "cuda:0,cuda:1" names.
struct Wanted {
  std::string kind;  ///< empty if they are no devices or of several kinds
  std::vector<int> numbers;
};

Wanted parse_list(const std::string& names) {
  Wanted wanted;
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, ',');) {
    const DeviceName device = parse_device(name);
    if (!wanted.numbers.empty() && device.kind != wanted.kind) return {};
    wanted.kind = device.kind;
    wanted.numbers.push_back(device.number);
  }
  return names.ends_with(',') ? Wanted{} : wanted;
}

}  // namespace

TrainDevice::TrainDevice(const std::string& names) : any_(names == "auto") {
  if (names == "cpu") return;
  LabellerDevices known;  // for what is said of an unknown one
  const Wanted wanted = any_ ? Wanted{{}, {0}} : parse_list(names);
  for (const Satellite& satellite : satellites()) {
    for (const TrainerDevice& trainer : satellite.trainers) {
      known.kinds.push_back({trainer.name, {}});
      if (!any_ && trainer.name != wanted.kind) continue;
      try {
        make_ = trainer.open(wanted.numbers);
        return;
      } catch (const DeviceError& e) {
        if (!any_) throw;
        say("note: " + std::string(e.what()) + "; the processor trains");
      }
    }
  }
  if (!any_) throw_unknown_device(names, known);
}

void TrainDevice::run(const std::vector<TrainingSet*>& sets, int trees_at_once,
                      const std::function<void(Executor&)>& train) const {
  if (make_) {
    try {
      train(*make_(sets, trees_at_once));
      return;
    } catch (const DeviceError& e) {
      if (!any_) throw;
      say("note: " + std::string(e.what()) + "; the processor goes on");
    }
  }
  LocalExecutor executor(sets, trees_at_once);
  train(executor);
}

}  // namespace vesalius::cli
