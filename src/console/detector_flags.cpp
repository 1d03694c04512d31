#include "console/detector_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "console/default_model.h"
#include "console/satellites.h"
#include "console/text_sink.h"
#include "io/files/data_file.h"
#include "io/files/options_file.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius::cli {

void replace_body(Model& model, const std::string& path) {
  BodyModel body = parse_body_model(read_file(path), path);
  const auto& trained = model.body.parts;
  for (std::size_t p = 0; p < std::max(body.parts.size(), trained.size()); ++p) {
    const std::string ours = p < body.parts.size() ? body.parts[p].name : "missing";
    const std::string theirs = p < trained.size() ? trained[p].name : "missing";
    if (ours == theirs) continue;
    throw Error(fmt::format("{}: part {} is {}, in the model {}; a body must have the model's parts in its order", path,
                            p, ours, theirs));
  }
  model.body = std::move(body);
}

PeopleOptions people_options(const std::string& options_file, const OptionFlags<PeopleOptions>& flags) {
  PeopleOptions options;
  if (!options_file.empty()) {
    read_options(options_file, [&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  }
  flags.apply(options);
  RangeCheck check;
  visit_options("", options, check);
  return options;
}

DetectorFlags::DetectorFlags(CLI::App& command) : device_(command, kDetectorGroup), options_(command) {
  command.add_option("-m,--model", model_, kModelHelp)->type_name("FILE");
  command.add_option("--options", options_file_, "TOML file of detector options")
      ->type_name("FILE")
      ->group(kDetectorGroup);
  command.add_option("--body", body_, "Body model with another tree or other joints for the same parts")
      ->type_name("FILE")
      ->group(kDetectorGroup);
}

std::string DetectorFlags::model() const { return model_.empty() ? default_model() : model_; }

PeopleOptions DetectorFlags::options() const { return people_options(options_file_, options_); }

Model DetectorFlags::loaded() const {
  Model loaded = load_model(model());
  if (!body_.empty()) replace_body(loaded, body_);
  return device_.make(std::move(loaded));
}

Detector DetectorFlags::make() const {
  const DetectOptions detect = options().detect;
  return Detector(loaded(), detect);
}

DeviceFlag::DeviceFlag(CLI::App& command, const std::string& group) {
  CLI::Option* option =
      command.add_option("--device", device_, device_help("What labels pixels", "cuda or cuda:N (a card)"));
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
