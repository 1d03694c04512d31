#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "cli/commands.h"
#include "cli/detect/latency.h"
#include "console/detector_flags.h"
#include "console/interrupts.h"
#include "console/machine_facts.h"
#include "console/source_flags.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "io/files/plain_text.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"
#include "vesalius/track_people.h"

namespace vesalius::cli {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct BenchArguments {
  explicit BenchArguments(CLI::App& command) : detector(command) {}

  std::string source, json;
  std::string threads = "both";
  SourceOptions camera;
  DetectorFlags detector;
  int frames = 0;
  bool track = false, quiet = false;
};

/// Measurements with one number of threads.
struct Run {
  int threads = 1;
  std::optional<PeopleTracker> tracker = {};  ///< none where people are not followed
  FrameTimes times = {};
  double processor_ms = 0.0;  ///< over all threads and frames

  double frames_per_s() const { return times.frames() == 0 ? 0.0 : 1000.0 / times.mean_people_ms(); }
  double processor_ms_a_frame() const { return processor_ms / double(times.frames()); }
};

struct Bench {
  std::vector<Run> runs;
  double ready_s = 0.0;  ///< time until model and detector were ready
  int width = 0, height = 0;
};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Returns the peak memory of the whole process so far, in units of 10^6 bytes.
double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) * 1024e-6;
}

std::vector<Run> runs_for(const std::string& threads) {
  const int all = thread_count();
  std::vector<Run> runs;
  if (threads == "both") {
    runs.emplace_back();
    if (all > 1) runs.emplace_back().threads = all;
    return runs;
  }
  int count = 0;
  if (!CLI::detail::lexical_cast(threads, count) || count < 0 || count > kMaxThreads) {
    throw UsageError(fmt::format("--threads {}: expected \"both\" or a number from 0 to {}", threads, kMaxThreads));
  }
  runs.emplace_back().threads = count == 0 ? all : count;
  return runs;
}

void measure(const Detector& detector, const Frame& frame, double read_ms, Run& run) {
  const ThreadLimit limit(run.threads);
  FollowReport report;
  const std::clock_t before = std::clock();
  if (run.tracker) {
    follow(detector, *run.tracker, frame, report);
  } else {
    detector.detect(frame, nullptr, &report.times);
  }
  run.processor_ms += double(std::clock() - before) * 1e3 / CLOCKS_PER_SEC;
  run.times.add(report.times, read_ms, -1.0);
  if (run.tracker) run.times.add_tracking(report.track_ms);
}

/// Measures every frame with each number of threads in turn, so that other load on the machine affects all of them
/// alike.
void measure_all(const BenchArguments& arguments, const Detector& detector, Bench& bench) {
  auto source = open_source(arguments.source, arguments.camera);
  const bool live = source->is_live();
  const int wanted = arguments.frames > 0 ? arguments.frames : source->size();
  Progress progress(wanted, !arguments.quiet);
  while ((wanted < 0 || progress.done() < wanted) && !interrupted()) {
    const auto start = Clock::now();
    std::optional<Frame> frame = source->next();
    if (!frame && (progress.done() == 0 || arguments.frames == 0 || live)) break;
    if (!frame) {
      source = open_source(arguments.source, arguments.camera);
      for (Run& run : bench.runs) {
        if (run.tracker) run.tracker = run.tracker->restarted();
      }
      continue;
    }
    // Of a camera that would be the time until it has the next frame.
    const double read_ms = live ? -1.0 : seconds_since(start) * 1e3;
    if (!frame->time_s) frame->time_s = progress.done() / kUsualRate;
    bench.width = frame->depth.width();
    bench.height = frame->depth.height();
    if (progress.done() == 0) detector.detect(*frame);  // fills pages and caches
    for (Run& run : bench.runs) measure(detector, *frame, read_ms, run);
    progress.step();
  }
  progress.clear();
  // What was measured of a camera until then is as good as more of it.
  if (interrupted() && !(live && progress.done() > 0))
    throw Error("interrupted after " + counted(progress.done(), "frame"));
  if (progress.done() == 0) throw Error(arguments.source + ": no frames to measure");
}

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

Json run_json(const Run& run) {
  Json stages = Json::object();
  for (const auto& [name, latency] : run.times.rows()) stages[name] = latency_json(latency);
  return {{"threads", run.threads},
          {"frames_per_s", rounded(run.frames_per_s(), 100)},
          {"processor_ms_a_frame", rounded(run.processor_ms_a_frame(), 100)},
          {"stages", std::move(stages)}};
}

void report(const BenchArguments& arguments, const Bench& bench) {
  const double memory = peak_memory_mb();
  const std::size_t frames = bench.runs.front().times.frames();
  Json runs = Json::array();
  std::string text =
      fmt::format("{}\n{} of {}x{}; ready after {:.2f} s, at most {:.0f} MB\n", machine_facts(),
                  counted(std::int64_t(frames), "frame"), bench.width, bench.height, bench.ready_s, memory);
  for (const Run& run : bench.runs) {
    runs.push_back(run_json(run));
    text += fmt::format("\n{} thread{}: {:.1f} frames/s, {:.1f} ms of processor time a frame\n{}", run.threads,
                        run.threads == 1 ? "" : "s", run.frames_per_s(), run.processor_ms_a_frame(), table(run.times));
  }
  if (!arguments.json.empty()) {
    const Json all = {{"source", arguments.source},
                      {"model", arguments.detector.model()},
                      {"machine", machine_facts()},
                      {"version", VESALIUS_VERSION},
                      {"frames", frames},
                      {"followed", arguments.track},
                      {"size_px", {bench.width, bench.height}},
                      {"ready_s", rounded(bench.ready_s, 1000)},
                      {"peak_memory_mb", rounded(memory, 10)},
                      {"runs", std::move(runs)}};
    TextSink sink(arguments.json);
    sink.line(all.dump(2, ' ', false, Json::error_handler_t::replace));
    sink.finish();
  }
  if (!arguments.quiet && arguments.json != "-") print(text);
}

void run_bench(const BenchArguments& arguments) {
  if (is_camera(arguments.source) && arguments.frames == 0) {
    throw UsageError(arguments.source + ": expected --frames N, since a camera has no last frame");
  }
  keep_freed_memory();
  Bench bench;
  bench.runs = runs_for(arguments.threads);
  const auto start = Clock::now();
  const Detector detector = arguments.detector.make();
  bench.ready_s = seconds_since(start);
  for (Run& run : bench.runs) {
    if (arguments.track) run.tracker = make_tracker(detector, arguments.detector.options());
  }
  watch_interrupts();
  measure_all(arguments, detector, bench);
  report(arguments, bench);
}

}  // namespace

void add_bench(CLI::App& program) {
  CLI::App* command = program.add_subcommand("bench", "Measure the detector's time and memory, stage by stage");
  const auto arguments = std::make_shared<BenchArguments>(*command);
  command->add_option("SOURCE", arguments->source, kSourceHelp)->required();
  add_camera_flags(*command, arguments->camera);
  add_start_flag(*command, arguments->camera);
  command
      ->add_option("--frames", arguments->frames,
                   "Frames to measure, repeating the source if needed; 0 = the whole source once, and no camera")
      ->type_name("N")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  command->add_option("--threads", arguments->threads, "Threads to use: a number, 0 = all, or both one and all")
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--track", arguments->track, "Follow the people as well");
  command->add_option("--json", arguments->json, "The figures as JSON; - is standard output")->type_name("FILE");
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  command->footer(R"(
Times are wall-clock times from a frame in memory to its people; "read" is the time to load it. Frames/s count one
frame after the other. Ctrl-C ends the measurement of a camera with the figures so far. Every detector option is a flag too; `vesalius options` lists them.

Example:
  vesalius bench frames/ --frames 300 --json bench.json)");
  command->callback([arguments] { run_bench(*arguments); });
}

}  // namespace vesalius::cli
