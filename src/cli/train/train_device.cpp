#include "cli/train/train_device.h"

#include <utility>

#include "cli/text_sink.h"
#include "train/local_executor.h"
#include "vesalius/base/error.h"
#include "vesalius/forest/make_labeller.h"

namespace vesalius::cli {

TrainDevice::TrainDevice(const std::string& name) : any_(name == "auto") {
  if (name == "cpu") return;
  LabellerDevices known;  // for what is said of an unknown one
  const DeviceName wanted = parse_device(name);
  for (const Satellite& satellite : satellites()) {
    for (const TrainerDevice& trainer : satellite.trainers) {
      known.kinds.push_back({trainer.name, {}});
      if (!any_ && trainer.name != wanted.kind) continue;
      try {
        make_ = trainer.open(any_ ? 0 : wanted.number);
        return;
      } catch (const DeviceError& e) {
        if (!any_) throw;
        say("note: " + std::string(e.what()) + "; the processor trains");
      }
    }
  }
  if (!any_) throw_unknown_device(name, known);
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
