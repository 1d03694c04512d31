#include "console/device_flag.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "console/satellites.h"
#include "console/text_sink.h"

namespace vesalius::cli {

DeviceFlag::DeviceFlag(CLI::App& command, const std::string& group) {
  CLI::Option* option =
      command.add_option("--device", device_,
                         "What labels pixels: cpu, cuda or cuda:N (a card), or auto, a card where one "
                         "works and otherwise the processor. The labels are the same");
  option->type_name("NAME")->capture_default_str();
  if (!group.empty()) option->group(group);
}

Model DeviceFlag::make(Model model) const {
  LabellerDevices devices{{}, [](const std::string& note) { say("note: " + note); }};
  for (const Satellite& satellite : satellites()) {
    for (const LabellerDevice& kind : satellite.devices) devices.kinds.push_back(kind);
  }
  return on_device(std::move(model), device_, devices);
}

}  // namespace vesalius::cli
