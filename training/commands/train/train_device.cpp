#include "commands/train/train_device.h"

#include <sstream>
#include <utility>

#include "console/text_sink.h"
#include "cuda/cuda_device.h"
#include "cuda_train/device_executor.h"
#include "cuda_train/train_kernels.h"
#include "train/local_executor.h"
#include "vesalius/error.h"
#include "vesalius/model.h"

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

constexpr const char* kCards = "cuda";

MakeExecutor open_cards(const std::vector<int>& numbers) {
  std::vector<std::shared_ptr<gpu::Device>> cards;
  for (const int number : numbers) cards.push_back(gpu::open_cuda_device(number, gpu::train_kernels_on_cards()));
  return [cards](const std::vector<TrainingSet*>& sets, int trees_at_once) {
    return std::make_unique<gpu::DeviceExecutor>(sets, cards, trees_at_once);
  };
}

}  // namespace

TrainDevice::TrainDevice(const std::string& names) : any_(names == "auto") {
  if (names == "cpu") return;
  const LabellerDevices known{{{kCards, {}}}, {}};  // for what is said of an unknown one
  const Wanted wanted = any_ ? Wanted{{}, {0}} : parse_list(names);
  if (!any_ && wanted.kind != kCards) throw_unknown_device(names, known);
  try {
    make_ = open_cards(wanted.numbers);
  } catch (const DeviceError& e) {
    if (!any_) throw;
    say("note: " + std::string(e.what()) + "; the processor trains");
  }
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
