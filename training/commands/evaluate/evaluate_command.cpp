#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "commands/evaluate/truth_recipe.h"
#include "commands/training_commands.h"
#include "console/default_model.h"
#include "console/detector_flags.h"
#include "console/interrupts.h"
#include "console/machine_facts.h"
#include "console/option_flags.h"
#include "console/satellites.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "dataset/open_truth.h"
#include "dataset/truth_csv.h"
#include "dataset/truth_folder.h"
#include "evaluation/evaluate_set.h"
#include "evaluation/evaluation_joints.h"
#include "evaluation/evaluation_json.h"
#include "evaluation/evaluation_report.h"
#include "io/files/data_file.h"
#include "io/files/plain_text.h"
#include "report/document.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

constexpr int kMaxStep = 1000000;
constexpr int kMaxCount = 1000000000;

/// A set to be evaluated, and how to open it.
struct Request {
  SetOptions set;
  bool is_recipe = false;
};

struct Arguments {
  explicit Arguments(CLI::App& command) : device(command), detector_flags(command) {}

  std::vector<std::string> sources, recipes;
  RenderedTruth rendered;
  std::optional<float> clip_s;
  std::optional<double> rate_hz;
  std::string model, options_file, report, json, joints_file, joint_set, headings_file;
  DeviceFlag device;
  OptionFlags<PeopleOptions> detector_flags;
  int step = 1;
  int threads = 0;
  bool labels_only = false;
  bool track = false;
  bool hidden = false;
  bool keep_going = false;
  bool quiet = false;
};

/// Returns the name as valid UTF-8 on one line, since names go into pictures and JSON.
std::string clean(const std::string& name) {
  const nlohmann::json json = one_line(name);
  return nlohmann::json::parse(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::filesystem::path whole_path(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path whole = std::filesystem::absolute(path, ignored).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

/// Returns what is rendered of recipes, with the length of clips.
RenderedTruth rendered_truth(const Arguments& arguments) {
  RenderedTruth rendered = arguments.rendered;
  if (arguments.rate_hz && !arguments.clip_s) throw UsageError("--rate expects --clip, the seconds of each clip");
  if (!arguments.clip_s) return rendered;
  if (arguments.recipes.empty()) throw UsageError("--clip expects --recipe, of which clips are rendered");
  rendered.clip = synth::ClipTiming{*arguments.clip_s, arguments.rate_hz.value_or(synth::ClipTiming{}.rate_hz)};
  check(*rendered.clip);
  return rendered;
}

/// Gives each source a distinct name: its last folder or, if these are not distinct, its path.
std::vector<Request> set_requests(const Arguments& arguments) {
  std::vector<Request> requests;
  std::set<std::string> paths, names;
  const auto add = [&](const std::string& source, const std::filesystem::path& path, std::string name, bool is_recipe) {
    if (!paths.insert(path.string()).second) throw UsageError(fmt::format("{}: given twice", source));
    if (!names.insert(name).second) name = clean(path.string());
    requests.push_back({{name, source, arguments.keep_going}, is_recipe});
  };
  for (const std::string& source : arguments.sources) {
    for (const std::string& set : arguments.track ? std::vector{source} : sets_in(source)) {
      const std::filesystem::path path = whole_path(set);
      add(set, path, clean(path.filename().string()), false);
    }
  }
  for (const std::string& recipe : arguments.recipes) {
    const std::filesystem::path path = whole_path(recipe);
    add(recipe, path, clean(path.stem().string()), true);
  }
  if (requests.empty()) throw UsageError("expected a source or --recipe to measure on");
  return requests;
}

/// Quotes a word for a shell.
std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("/._-:+,=@%").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Returns an option as it was given: "--step 2", "--no-refine.second-pass", or the words of a positional argument.
std::string as_given(const CLI::Option& option) {
  const std::vector<std::string>& names = option.get_lnames();
  std::string text;
  if (!names.empty()) {
    const bool negated = option.get_items_expected_max() == 0 && option.results() == std::vector<std::string>{"false"};
    text += " --" + (negated ? names.back() : names.front());
  }
  if (option.get_items_expected_max() == 0) return text;
  for (const std::string& value : option.results()) text += " " + shell_word(value);
  return text;
}

/// Returns the command as it was given, with the options in the order in which the program defines them.
std::string command_line(const CLI::App& command) {
  std::string line = "vesalius " + command.get_name();
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0) line += as_given(*option);
  }
  return one_line(line);
}

/// Opens the frames of a source with what the command line adds to them.
std::unique_ptr<TruthSource> open_frames(const std::string& source, const Arguments& arguments) {
  auto frames = open_truth(source, arguments.step);
  if (!arguments.headings_file.empty()) {
    const std::string set = whole_path(source).filename().string();
    frames = with_headings(std::move(frames), HeadingTable::read(arguments.headings_file), set);
  }
  return frames;
}

/// Opens the frames of a set. Where people are followed, the folders of a source are recordings of one set.
std::unique_ptr<TruthSource> open_set(const Request& request, const Arguments& arguments, const BodyModel& body) {
  const std::string& source = request.set.source;
  if (request.is_recipe) {
    return open_recipe_truth(source, rendered_truth(arguments), arguments.step, body);
  }
  if (!arguments.track) return open_frames(source, arguments);
  return open_sequences(source, [&arguments](const std::string& folder) { return open_frames(folder, arguments); });
}

SetResult evaluate_shown(const Request& request, const Arguments& arguments, const FrameScorer& scorer,
                         const SequenceTrackerFactory& trackers) {
  const OpenTruth open = [&] { return open_set(request, arguments, scorer.body()); };
  const auto frames = open();
  for (const std::string& note : frames->notes()) say(fmt::format("note: {}: {}", request.set.name, note));
  Progress progress(-1, !arguments.quiet);
  EvaluationHooks hooks;
  hooks.progress = [&](int done, int total) { progress.set(done, total); };
  hooks.failure = [&](const std::string& why) {
    progress.clear();
    say("vesalius: " + why);
  };
  hooks.stop = interrupted;
  if (!arguments.track) return evaluate_set(*frames, request.set, scorer, hooks);
  return evaluate_sequences(open, request.set, scorer, trackers, {.hidden = arguments.hidden}, hooks);
}

/// Returns whether nothing but the JSON may go to standard output.
bool prints_json(const Arguments& arguments) { return arguments.json == "-"; }

void write_outputs(const Arguments& arguments, const Evaluation& evaluation) {
  if (!arguments.json.empty()) {
    TextSink sink(arguments.json);
    sink.line(evaluation_json(evaluation));
    sink.finish();
  }
  if (!arguments.report.empty()) write_report(evaluation, arguments.report);
}

void run(const Arguments& arguments, const std::string& command) {
  const ThreadLimit limit(arguments.threads);
  const std::vector<Request> requests = set_requests(arguments);
  (void)rendered_truth(arguments);  // before anything is read
  const std::string path = arguments.model.empty() ? default_model() : arguments.model;
  const std::string bytes = read_file(path);
  Model model = parse_model(bytes, path);
  model.body = arguments.joints_file.empty() ? with_evaluation_joints(model.body)
                                             : with_joints_of(model.body, arguments.joints_file);
  Evaluation evaluation;
  evaluation.options = people_options(arguments.options_file, arguments.detector_flags);
  evaluation.labels_only = arguments.labels_only;
  evaluation.command = command;
  evaluation.model = path;
  evaluation.model_checksum = model_checksum(bytes);
  evaluation.version = VESALIUS_VERSION;
  evaluation.machine = machine_facts();
  const FrameScorer::Options scored{evaluation.options.detect, arguments.labels_only, arguments.joint_set};
  model = arguments.device.make(std::move(model));
  const FrameScorer scorer(model, scored);
  SequenceTrackerFactory trackers;
  if (arguments.track) trackers = sequence_trackers(model, evaluation.options);
  evaluation.tracked = arguments.track;
  evaluation.body = scorer.body();
  if (!arguments.report.empty()) make_report_folder(arguments.report);
  watch_interrupts();
  int failed = 0;
  for (const Request& request : requests) {
    evaluation.sets.push_back(evaluate_shown(request, arguments, scorer, trackers));
    failed += evaluation.sets.back().failed;
    if (!prints_json(arguments)) print(summary_lines(evaluation.sets.back()));
    std::fflush(stdout);  // a set can take minutes
  }
  write_outputs(arguments, evaluation);
  if (!arguments.quiet && arguments.report.empty() && arguments.json.empty()) {
    say("note: all metrics, plots and the worst frames: --report DIR");
  }
  if (failed > 0) throw Error(counted(failed, "frame") + " failed");
}

std::string comparison_line(const Comparison& c) {
  const Metric metric = c.id.metric;
  const bool worse = c.verdict == Comparison::Verdict::worse;
  return fmt::format("  {:<34} {:>10} -> {:>10}  {:>10} ({} to {})  {}\n", c.id.name(), metric_text(metric, c.first),
                     metric_text(metric, c.second), metric_difference_text(metric, c.difference),
                     metric_difference_text(metric, c.interval.low), metric_difference_text(metric, c.interval.high),
                     worse ? "WORSE" : verdict_word(c.verdict));
}

void compare(const std::string& first, const std::string& second, bool all) {
  const std::vector<SetComparison> sets = compare_evaluations(read_evaluation(first), read_evaluation(second));
  if (std::ranges::none_of(sets, &SetComparison::in_both)) {
    throw Error(fmt::format("{} and {} have no set in common", first, second));
  }
  std::string text;
  std::array<int, 3> tally{};  // number of metrics for each verdict
  for (const SetComparison& set : sets) {
    if (!set.in_both) {
      text += fmt::format("{}: only in {}\n", one_line(set.name), first);
      continue;
    }
    text += one_line(set.name) + (set.paired ? "\n" : " (not the same frames: wider intervals)\n");
    for (const Comparison& comparison : set.metrics) {
      ++tally[static_cast<std::size_t>(comparison.verdict)];
      if (all || comparison.verdict != Comparison::Verdict::same) text += comparison_line(comparison);
    }
  }
  print(text + fmt::format("{} better, {} worse, {} the same (95 % intervals of the difference)\n", tally[0], tally[1],
                           tally[2]));
}

}  // namespace

void add_evaluate(CLI::App& program) {
  CLI::App* command = program.add_subcommand("evaluate", "Measure a model against frames whose truth is known");
  const auto arguments = std::make_shared<Arguments>(*command);
  command->add_option(
      "SOURCE", arguments->sources,
      "Labelled datasets of `vesalius synth`, folders of frames with frames.csv, mask/ or joints.csv, or a "
      "folder of such folders with one frames.csv");
  command
      ->add_option("--recipe", arguments->recipes,
                   "Frames rendered from this recipe and not kept, as `vesalius synth --recipe` makes them")
      ->type_name("FILE");
  command->add_option("--count", arguments->rendered.count, "Frames of each recipe; with --clip clips")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxCount));
  command
      ->add_option("--clip", arguments->clip_s,
                   "Clips of so many seconds of each recipe instead of single frames, as `vesalius synth --clip`")
      ->type_name("SECONDS");
  command->add_option("--rate", arguments->rate_hz, "Frames a second of clips (default: 30)")->type_name("HZ");
  command->add_option("--render-seed", arguments->rendered.seed, "Seed of the recipes' frames")->type_name("N");
  command->add_option("--assets", arguments->rendered.assets.folder, "Folder in which `vesalius assets` put its files")
      ->type_name("DIR");
  command->add_option("-m,--model", arguments->model, kModelHelp)->type_name("FILE");
  command->add_option("--report", arguments->report, "Folder for report.html, report.json and figures.csv")
      ->type_name("DIR");
  command->add_option("--json", arguments->json, "Metrics as JSON, for `vesalius compare`; - for standard output")
      ->type_name("FILE");
  command->add_option("--options", arguments->options_file, "TOML file of options, as `vesalius options` prints them")
      ->type_name("FILE");
  command->add_option("--step", arguments->step, "Only the first of every N frames")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxStep));
  command->add_flag("--labels-only", arguments->labels_only, "Only the pixel labels of the first pass: much faster");
  command
      ->add_option("--joints", arguments->joints_file,
                   "TOML with joint sets named as the truth names its joints, instead of those built in")
      ->type_name("FILE");
  command
      ->add_option("--joint-set", arguments->joint_set,
                   "Joint set to compare the truth's joints with, e.g. kinect20; by default the truth's choice")
      ->type_name("NAME");
  command
      ->add_option("--headings", arguments->headings_file,
                   "Table of the side that people turn to the camera: columns set (the last folder of the source), "
                   "frame, heading (front, side, back)")
      ->type_name("FILE");
  CLI::Option* track =
      command
          ->add_flag(
              "--track", arguments->track,
              "Follow the people over each recording, frame after frame, and measure ids and motion too; a folder "
              "of recordings is one set")
          ->excludes("--labels-only");
  command
      ->add_flag(
          "--hidden", arguments->hidden,
          "With --track: people who are hidden take part, true and tracked ones, instead of only those with pixels")
      ->needs(track);
  command->add_option("--threads", arguments->threads, "Threads to use; 0 = all. The metrics are the same")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads));
  command->add_flag("--keep-going", arguments->keep_going, "Skip frames that fail; the exit code is then 1");
  command->add_flag("-q,--quiet", arguments->quiet, "Print no progress");
  command->footer(R"(
Every option of detector, tracking and fitted bodies is a flag too, e.g. --search.min-parts 6; `vesalius options` lists
them. docs/metrics.md says what the metrics mean.

Examples:
  vesalius evaluate held_out/ -m adult.forest --report out/
  vesalius evaluate --recipe data/protocol/cluttered.toml --count 5000 -m adult.forest
  vesalius evaluate real/room real/hall -m adult.forest --json a.json
  vesalius evaluate recordings/ -m adult.forest --track)");
  command->callback([arguments, command] { run(*arguments, command_line(*command)); });
}

void add_compare(CLI::App& program) {
  CLI::App* command = program.add_subcommand("compare", "Compare two evaluations metric by metric");
  const auto first = std::make_shared<std::string>();
  const auto second = std::make_shared<std::string>();
  const auto all = std::make_shared<bool>(false);
  command->add_option("FIRST", *first, "report.json of `vesalius evaluate`")->required();
  command->add_option("SECOND", *second, "The same for another model or other options")->required();
  command->add_flag("--all", *all, "Print also metrics that do not differ");
  command->footer(R"(
If both evaluations saw the same frames, differences are resampled frame by frame, which shows even small ones. About one
in twenty metrics without a difference is called better or worse by chance.)");
  command->callback([first, second, all] { compare(*first, *second, *all); });
}

Satellite evaluate_satellite() { return {.name = "evaluate", .commands = {add_evaluate, add_compare}}; }

}  // namespace vesalius::cli
