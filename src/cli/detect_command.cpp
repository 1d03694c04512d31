#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/commands.h"
#include "cli/detect_outputs.h"
#include "cli/interrupts.h"
#include "cli/option_flags.h"
#include "cli/progress.h"
#include "cli/source_flags.h"
#include "io/model_file.h"
#include "io/options_file.h"
#include "io/read_file.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

constexpr int kMaxThreads = 1024;

struct Arguments {
  explicit Arguments(CLI::App& command) : detector_flags(command) {}

  std::string source, model, body, options_file;
  SourceOptions camera;
  OutputRequest outputs;
  OptionFlags<DetectOptions> detector_flags;
  int threads = 0;
  bool keep_going = false;
  bool quiet = false;
};

/// Another kinematic tree or other joints for the same parts.
void replace_body(Forest& forest, const std::string& path) {
  BodyModel body = parse_body_model(read_file(path), path);
  const auto& trained = forest.body.parts;
  for (std::size_t p = 0; p < std::max(body.parts.size(), trained.size()); ++p) {
    const std::string ours = p < body.parts.size() ? body.parts[p].name : "missing";
    const std::string theirs = p < trained.size() ? trained[p].name : "missing";
    if (ours == theirs) continue;
    throw Error(fmt::format("{}: part {} is {}, in the model {}; a body must have the model's parts in its order", path,
                            p, ours, theirs));
  }
  forest.body = std::move(body);
}

Detector make_detector(const Arguments& arguments) {
  DetectOptions options;
  if (!arguments.options_file.empty()) {
    read_options(arguments.options_file, [&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  }
  arguments.detector_flags.apply(options);
  RangeCheck check;
  visit_options("", options, check);
  Forest forest = load_model(arguments.model);
  if (!arguments.body.empty()) replace_body(forest, arguments.body);
  return Detector(std::move(forest), options);
}

struct Totals {
  int people = 0;
  int frames_with_people = 0;
  int failed = 0;
};

/// One frame from source to outputs; false at the end of the source.
bool detect_next(FrameSource& source, const Detector& detector, DetectOutputs& outputs, Totals& totals) {
  const std::optional<Frame> frame = source.next();
  if (!frame) return false;
  const std::vector<Person> people = detector.detect(*frame);
  outputs.write(*frame, people);
  totals.people += static_cast<int>(people.size());
  totals.frames_with_people += people.empty() ? 0 : 1;
  return true;
}

Totals detect_all(const Arguments& arguments, FrameSource& source, const Detector& detector, DetectOutputs& outputs,
                  Progress& progress) {
  Totals totals;
  for (bool more = true; more && !interrupted();) {
    try {
      more = detect_next(source, detector, outputs, totals);
    } catch (const BrokenPipe&) {
      throw;
    } catch (const Error& e) {
      if (!arguments.keep_going) throw;
      progress.clear();
      say(std::string("vesalius: ") + e.what());
      ++totals.failed;
    }
    if (more) progress.step();
  }
  return totals;
}

void run(const Arguments& arguments) {
  check(arguments.outputs);
  const ThreadLimit limit(arguments.threads);
  const Detector detector = make_detector(arguments);
  const auto source = open_source(arguments.source, arguments.camera);
  if (!arguments.quiet) {
    for (const std::string& note : source->notes()) say("note: " + note);
  }
  OutputRequest request = arguments.outputs;
  request.lines = !arguments.quiet && request.json != "-";
  watch_interrupts();
  DetectOutputs outputs(request, detector.body());
  Progress progress(source->size(), !arguments.quiet);
  const Totals totals = detect_all(arguments, *source, detector, outputs, progress);
  progress.clear();
  if (interrupted()) throw Error(fmt::format("interrupted after {} frames", progress.done()));
  outputs.finish();
  if (!arguments.quiet) {
    say(fmt::format("{} frames, people in {} of them ({} in all), {:.1f} s, {:.1f} frames/s", progress.done(),
                    totals.frames_with_people, totals.people, progress.seconds(),
                    progress.done() / progress.seconds()));
  }
  if (totals.failed > 0) throw Error(fmt::format("{} of {} frames failed", totals.failed, progress.done()));
}

void add_output_flags(CLI::App& command, OutputRequest& outputs) {
  const std::string group = "Output (without any of these: a line per frame)";
  command.add_option("--json", outputs.json, "People as JSON, one line a frame; - is standard output")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--out", outputs.folder, "Folder for pictures; made if missing")->type_name("DIR")->group(group);
  command
      .add_option(
          "--save", outputs.save,
          "What to put into --out, separated by commas: overlay (default) and parts, pictures of skeletons and of "
          "body parts; labels (part of each pixel) and mask (person of each pixel) as numbers; cloud (labelled "
          "PLY); video")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(kSaveKinds))
      ->group(group);
  command.add_option("--video-rate", outputs.video_rate, "Frames per second of the video")
      ->type_name("N")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str()
      ->group(group);
}

}  // namespace

void add_detect(CLI::App& program) {
  CLI::App* command = program.add_subcommand("detect", "Find people in frames");
  const auto arguments = std::make_shared<Arguments>(*command);
  command->add_option("SOURCE", arguments->source, kSourceHelp)->required();
  command->add_option("-m,--model", arguments->model, "Trained forest, e.g. capsule.forest")
      ->type_name("FILE")
      ->required();
  add_output_flags(*command, arguments->outputs);
  add_camera_flags(*command, arguments->camera);
  const std::string group = "Detector";
  command->add_option("--options", arguments->options_file, "TOML file of detector options")
      ->type_name("FILE")
      ->group(group);
  command->add_option("--body", arguments->body, "Body model with another tree or other joints for the same parts")
      ->type_name("FILE")
      ->group(group);
  command->add_option("--threads", arguments->threads, "Threads to use; 0 = all. The result is the same")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads))
      ->group(group);
  command->add_flag("--keep-going", arguments->keep_going, "Pass over frames that fail; exit code 1 at the end");
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  command->footer(R"(
Every detector option is a flag too, e.g. --search.min-parts 6; `vesalius options` lists them.

Examples:
  vesalius detect frames/ -m capsule.forest
  vesalius detect tum:walking -m capsule.forest --json - | jq .people
  vesalius detect depth.png --fx 525 -m capsule.forest --out found/ --save overlay,mask)");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace vesalius::cli
