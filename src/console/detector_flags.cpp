#include "console/detector_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "console/default_model.h"
#include "io/files/options_file.h"
#include "io/files/read_file.h"
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
  command.add_option("-m,--model", model_, "Trained forest; without it the default.forest that comes with vesalius")
      ->type_name("FILE");
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

}  // namespace vesalius::cli
