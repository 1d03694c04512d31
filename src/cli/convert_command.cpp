#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "console/detector_flags.h"
#include "console/interrupts.h"
#include "console/source_flags.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "io/files/data_file.h"
#include "io/files/plain_text.h"
#include "io/model/model_contents.h"
#include "io/model/model_sections.h"
#include "io/model/old_model.h"
#include "io/model/text_trees.h"
#include "io/sources/write_frames.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius::cli {
namespace {

constexpr const char *kForestExtension = ".forest", *kModelExtension = ".model", *kNetworkExtension = ".network";

bool names_model(const std::string& path) {
  return path.ends_with(kForestExtension) || path.ends_with(kModelExtension);
}

struct ConvertArguments {
  std::vector<std::string> paths;
  std::string format, body;
  SourceOptions camera;
  WriteOptions write;
  bool quiet = false;
};

/// Reads a model of this version or of the one before.
Model load_any_model(const std::string& path) {
  const std::string bytes = read_file(path);
  return model_version(bytes) == kOldModelVersion ? parse_old_model(bytes, path) : parse_model(bytes, path);
}

/// Reads what training a network leaves: of the body in a file, or of the paper's without one.
Model import_network(const std::string& path, const std::string& body) {
  Model model;
  model.body = body.empty() ? paper_body() : parse_body_model(read_file(body), body);
  model.network = std::make_shared<Network>(load_network(path, model.body.part_count()));
  return model;
}

void convert_model(std::vector<std::string> paths, const std::string& body, bool quiet) {
  const std::string out = paths.back();
  paths.pop_back();
  if (!names_model(out)) {
    throw UsageError(fmt::format("{}: expected a name that ends in {} or {} (frames are converted with --to)", out,
                                 kForestExtension, kModelExtension));
  }
  const bool is_model = names_model(paths.front()), is_network = paths.front().ends_with(kNetworkExtension);
  if ((is_model || is_network) && paths.size() > 1) {
    throw UsageError(fmt::format("{}: expected one other name, since it is a model", paths.front()));
  }
  Model model = is_model     ? load_any_model(paths.front())
                : is_network ? import_network(paths.front(), body)
                             : Model(import_text_trees(paths));
  if (!body.empty() && !is_network) replace_body(model, body);
  save_model(model, out);
  if (quiet) return;
  say(model.network != nullptr ? fmt::format("{}: a network of {} layers", out, model.network->layers.size())
                               : out + ": " + counted(std::ssize(model.forest.trees), "tree"));
}

void convert_frames(const ConvertArguments& arguments) {
  if (arguments.paths.size() != 2) throw UsageError("--to expects a source and one folder to write");
  const FrameFormat format = parse_frame_format(arguments.format);
  const auto source = open_source(arguments.paths[0], arguments.camera);
  watch_interrupts();
  const auto writer = make_frame_writer(format, arguments.paths[1], arguments.write);
  if (!arguments.quiet) {
    for (const std::string& note : source->notes()) say("note: " + note);
    if (format == FrameFormat::tum) say("note: this layout names frames by their times, in seconds");
  }
  Progress progress(source->size(), !arguments.quiet);
  while (const auto frame = source->next()) {
    writer->write(*frame);
    progress.step();
    if (interrupted()) throw Error("interrupted after " + counted(progress.done(), "frame"));
  }
  writer->close();
  progress.clear();
  if (!arguments.quiet) say(arguments.paths[1] + ": " + counted(progress.done(), "frame"));
}

}  // namespace

void add_convert(CLI::App& program) {
  CLI::App* command = program.add_subcommand("convert",
                                             "Turn text trees or a model of an older format into a model, change a "
                                             "model's body, or turn frames into another layout");
  const auto arguments = std::make_shared<ConvertArguments>();
  command
      ->add_option(
          "PATH", arguments->paths,
          "Text trees (.txt or .txt.bz2) or a model, and the .forest to write; with --to a source and a folder")
      ->required()
      ->expected(2, 257);
  command->add_option("--body", arguments->body, "Body model to put into the model, for the same parts")
      ->type_name("FILE");
  command->add_option("--to", arguments->format, "Write frames in this layout")
      ->check(CLI::IsMember({"folder", "tum"}))
      ->excludes("--body");
  command
      ->add_option("--rate", arguments->write.frame_rate,
                   "Frames per second, for --to tum and --to folder of a source that does not know its frames' times")
      ->type_name("N")
      ->check(CLI::Range(0.1, 1000.0));
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  add_camera_flags(*command, arguments->camera);
  add_start_flag(*command, arguments->camera);
  command->footer(R"(
Examples:
  vesalius convert tree_1.txt.bz2 tree_2.txt.bz2 released.forest
  vesalius convert old.forest new.forest --body data/bodies/paper25.toml
  vesalius convert tum:walking frames/ --to folder
  vesalius convert frames/ as_tum/ --to tum --rate 30)");
  command->callback([arguments] {
    if (arguments->format.empty()) {
      convert_model(arguments->paths, arguments->body, arguments->quiet);
    } else {
      convert_frames(*arguments);
    }
  });
}

}  // namespace vesalius::cli
