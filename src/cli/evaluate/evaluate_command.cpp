#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/commands.h"
#include "cli/detector_flags.h"
#include "cli/evaluate/ablation.h"
#include "cli/evaluate/evaluate_ablation.h"
#include "cli/evaluate/evaluate_report.h"
#include "cli/evaluate/evaluate_set.h"
#include "cli/interrupts.h"
#include "cli/option_flags.h"
#include "cli/progress.h"
#include "cli/text_sink.h"
#include "dataset/truth_folder.h"
#include "io/files/atomic_file.h"
#include "io/files/read_file.h"
#include "io/model/model_file.h"
#include "vesalius/base/parallel.h"
#include "vesalius/forest/make_labeller.h"

namespace vesalius::cli {
namespace {

constexpr int kMaxStep = 1000000;
constexpr int kMaxCount = 1000000000;
constexpr std::size_t kWorstFrames = 3;

constexpr const char* kEvaluationJoints =
#include "evaluation_joints.inc"
    ;

struct Arguments {
  explicit Arguments(CLI::App& command) : detector_flags(command) {}

  std::vector<std::string> sources, recipes;
  RenderedTruth rendered;
  std::string model, options_file, report, json, joints_file, fit_joints, fit_score;
  OptionFlags<DetectOptions> detector_flags;
  int step = 1;
  int threads = 0;
  bool labels_only = false;
  bool ablation = false;
  bool keep_going = false;
  bool quiet = false;
};

bool has_set(const BodyModel& body, const std::string& name) {
  return std::ranges::find(body.joint_sets, name, &JointSet::name) != body.joint_sets.end();
}

/// The joints that data sets have, put to the body's own; a body of other parts goes without.
BodyModel with_joints(const BodyModel& body, const std::string& joints_file) {
  if (!joints_file.empty()) {
    const auto lines = std::ranges::count(body.toml, '\n') + 1;
    return parse_body_model(body.toml + "\n" + read_file(joints_file),
                            fmt::format("{}, after the {} lines of the model's body", joints_file, lines));
  }
  if (has_set(body, "kinect20") || has_set(body, "itop15") || has_set(body, "part_centres")) return body;
  for (const BodyPart& part : paper_body().parts) {
    if (body.find_part(part.name) < 0) return body;
  }
  return parse_body_model(body.toml + "\n" + kEvaluationJoints, "joints for evaluation");
}

/// Valid UTF-8 on one line: names go into pictures and JSON.
std::string clean(const std::string& name) {
  const nlohmann::json json = one_line(name);
  return nlohmann::json::parse(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::filesystem::path whole_path(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path whole = std::filesystem::absolute(path, ignored).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

/// Names that tell the sources apart: their last folders, or where these are the same, their paths.
std::vector<SetRequest> set_requests(const Arguments& arguments) {
  std::vector<SetRequest> requests;
  std::set<std::string> paths, names;
  for (const std::string& source : arguments.sources) {
    for (const std::string& set : sets_in(source)) {
      const std::filesystem::path path = whole_path(set);
      if (!paths.insert(path.string()).second) throw UsageError(fmt::format("{}: given twice", set));
      std::string name = clean(path.filename().string());
      if (!names.insert(name).second) name = clean(path.string());
      requests.push_back({name, set, arguments.step, arguments.keep_going, kWorstFrames, {}});
    }
  }
  for (const std::string& recipe : arguments.recipes) {
    const std::filesystem::path path = whole_path(recipe);
    if (!paths.insert(path.string()).second) throw UsageError(fmt::format("{}: given twice", recipe));
    std::string name = clean(path.stem().string());
    if (!names.insert(name).second) name = clean(path.string());
    requests.push_back({name, recipe, arguments.step, arguments.keep_going, kWorstFrames, arguments.rendered});
  }
  if (requests.empty()) throw UsageError("expected a source or --recipe to measure on");
  return requests;
}

/// A word as a shell takes it back.
std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("/._-:+,=@%").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// An option as it was given: "--step 2", "--no-refine.second-pass", or the words of a positional one.
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

/// The command that was given, with every option in the order in which the program knows them.
std::string command_line(const CLI::App& command) {
  std::string line = "vesalius " + command.get_name();
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0) line += as_given(*option);
  }
  return one_line(line);
}

SetResult evaluate_shown(const SetRequest& request, const FrameScorer& scorer, const std::vector<Variant>& variants,
                         bool quiet) {
  Progress progress(-1, !quiet);
  return evaluate_set(request, scorer, variants, progress);
}

void write_outputs(const Arguments& arguments, const Evaluation& evaluation) {
  if (!arguments.json.empty()) write_file_atomically(arguments.json, evaluation_json(evaluation));
  if (!arguments.report.empty()) write_report(evaluation, arguments.report);
  if (!arguments.fit_joints.empty()) write_file_atomically(arguments.fit_joints, fitted_joints_toml(evaluation));
  if (!arguments.fit_score.empty()) write_fitted_score(evaluation, arguments.fit_score);
}

void run(const Arguments& arguments, const std::string& command) {
  const ThreadLimit limit(arguments.threads);
  const std::vector<SetRequest> requests = set_requests(arguments);
  const std::string bytes = read_file(arguments.model);
  Forest forest = parse_model(bytes, arguments.model);
  forest.body = with_joints(forest.body, arguments.joints_file);
  Evaluation evaluation;
  evaluation.options = detect_options(arguments.options_file, arguments.detector_flags);
  evaluation.labels_only = arguments.labels_only;
  evaluation.has_background = forest.has_background;
  evaluation.command = command;
  evaluation.model = arguments.model;
  evaluation.model_checksum = model_checksum(bytes);
  std::vector<Variant> variants;
  if (arguments.ablation) variants = ablation_variants(forest, evaluation.options);
  const FrameScorer scorer(make_labeller(std::move(forest)), {evaluation.options, arguments.labels_only});
  evaluation.body = scorer.body();
  if (!arguments.report.empty()) prepare_report(arguments.report);
  watch_interrupts();
  int failed = 0;
  for (const SetRequest& request : requests) {
    evaluation.sets.push_back(evaluate_shown(request, scorer, variants, arguments.quiet));
    failed += evaluation.sets.back().failed;
    print(summary_lines(evaluation.sets.back()) + ablation_lines(evaluation.sets.back()));
    std::fflush(stdout);  // a set can take minutes
  }
  write_outputs(arguments, evaluation);
  if (failed > 0) throw Error(fmt::format("{} frames failed", failed));
}

}  // namespace

void add_evaluate(CLI::App& program) {
  CLI::App* command = program.add_subcommand("evaluate", "Measure a model against frames whose truth is known");
  const auto arguments = std::make_shared<Arguments>(*command);
  command->add_option("SOURCE", arguments->sources,
                      "Labelled datasets of `vesalius synth`, folders of frames with frames.csv, mask/, joints.csv or "
                      "truth_bvh.toml, a folder of such folders with one frames.csv, or ITOP_..._depth_map.h5");
  command
      ->add_option("--recipe", arguments->recipes,
                   "Frames rendered from this recipe and not kept, as `vesalius synth --recipe` makes them")
      ->type_name("FILE");
  command->add_option("--count", arguments->rendered.count, "Frames of each recipe")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxCount));
  command->add_option("--render-seed", arguments->rendered.seed, "Seed of the recipes' frames")->type_name("N");
  command->add_option("--assets", arguments->rendered.assets.folder, "Where `vesalius assets` put its files")
      ->type_name("DIR");
  command->add_option("-m,--model", arguments->model, "Trained forest")->type_name("FILE")->required();
  command
      ->add_option("--report", arguments->report,
                   "Folder for report.html, report.md, report.json, figures.csv (and ablation.csv)")
      ->type_name("DIR");
  command->add_option("--json", arguments->json, "Figures as JSON, for `vesalius compare`")->type_name("FILE");
  command->add_option("--options", arguments->options_file, "TOML file of detector options")->type_name("FILE");
  command->add_option("--step", arguments->step, "Only the first of every N frames")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxStep));
  CLI::Option* labels_only = command->add_flag("--labels-only", arguments->labels_only,
                                               "Only the pixel labels of the first pass: much faster");
  command
      ->add_flag("--ablation", arguments->ablation,
                 "Also without each part of the method in turn, with time a frame: some fifteen times as long")
      ->excludes(labels_only);
  command
      ->add_option("--joints", arguments->joints_file,
                   "TOML with joint sets named as the truth names its joints, instead of those built in")
      ->type_name("FILE");
  command
      ->add_option("--fit-joints", arguments->fit_joints,
                   "Write the joint sets used, with depth offsets fitted on every 10th frame")
      ->type_name("FILE");
  command
      ->add_option("--fit-score", arguments->fit_score,
                   "Write the detector options used, with the weights of the person score fitted to these frames")
      ->type_name("FILE")
      ->excludes(labels_only);
  command->add_option("--threads", arguments->threads, "Threads to use; 0 = all. The figures are the same")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads));
  command->add_flag("--keep-going", arguments->keep_going, "Pass over frames that fail; exit code 1 at the end");
  command->add_flag("-q,--quiet", arguments->quiet, "No progress");
  command->footer(R"(
Every detector option is a flag too, e.g. --search.min-parts 6; `vesalius options` lists them. docs/metrics.md says what
the figures mean.

Examples:
  vesalius evaluate held_out/ -m adult.forest --report out/
  vesalius evaluate --recipe data/protocol/cluttered.toml --count 5000 -m adult.forest
  vesalius evaluate real/room real/hall -m adult.forest --json a.json
  vesalius evaluate held_out/ empty_rooms/ -m adult.forest --fit-score detector.toml)");
  command->callback([arguments, command] { run(*arguments, command_line(*command)); });
}

}  // namespace vesalius::cli
