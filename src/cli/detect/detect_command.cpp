#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <sstream>

#include "cli/commands.h"
#include "cli/detect/detect_outputs.h"
#include "cli/detect/latency.h"
#include "console/detector_flags.h"
#include "console/interrupts.h"
#include "console/merge_flags.h"
#include "console/source_flags.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "io/files/plain_text.h"
#include "stream/turn_hint.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/detect_stream.h"
#include "vesalius/parallel.h"
#include "vesalius/stage_times.h"

namespace vesalius::cli {
namespace {

struct DetectArguments {
  explicit DetectArguments(CLI::App& command) : detector(command) {}

  SourceFlags source;
  MergeFlags merge;
  OutputRequest outputs;
  DetectorFlags detector;
  StreamOptions stream;
  int threads = 0;
  int frames = 0;             ///< 0 = all
  std::optional<bool> track;  ///< whether to follow people; nothing: where the frames are a sequence
  bool timing = false;
  bool keep_going = false;
};

struct Totals {
  bool follows = false;  ///< whether people are followed
  int people = 0;
  int frames_with_people = 0;
  int failed = 0;
  int dropped = 0;
  std::set<int> ids;  ///< ids of people who were followed, without those of whom one frame's guess was all
  FrameTimes times;
};

/// Writes the people found in one frame. Rethrows what reading or detecting threw.
void write_found(const FoundFrame& found, DetectOutputs& outputs, Totals& totals) {
  if (found.error) std::rethrow_exception(found.error);
  const double write_ms = elapsed_ms([&] { outputs.write(found); });
  totals.times.add(found.times, found.read_ms, write_ms);
  if (found.people.followed) totals.times.add_tracking(found.track_ms);
  if (found.latency_ms) totals.times.add_latency(*found.latency_ms);
  const std::vector<TrackedPerson>& people = found.people.people;
  for (const TrackedPerson& person : people) {
    if (person.state == TrackState::tracked) totals.ids.insert(person.id);
  }
  totals.people += int(std::ranges::count_if(people, is_found));
  totals.frames_with_people += std::ranges::any_of(people, is_found) ? 1 : 0;
}

void detect_all(const DetectArguments& arguments, FrameSource& source, const Detector& detector,
                std::optional<MergedCameras> cameras, DetectOutputs& outputs, LateLines& late, Progress& progress,
                Totals& totals) {
  StreamOptions options = arguments.stream;
  options.stop = [&] {
    late.print(progress);
    return interrupted();
  };
  TurnHint hint(detector);
  const auto tell = [&](const std::optional<std::string>& note) {
    if (note) late.add("note: " + *note);
  };
  std::size_t lossy = 0;  // addresses of which was said that they cannot be reached
  int number = 0;         // of frames that could be read
  const auto take = [&](FoundFrame found) {
    // On a terminal both appear, and a printed line must not follow the changing one in the same row.
    if (arguments.outputs.lines() || arguments.outputs.json == "-") progress.clear();
    try {
      if (cameras && !found.error) {
        const double time_s = moment_of(*found.frame, number++ / kUsualRate);
        found.people = cameras->merge(*found.frame, time_s, std::move(found.people));
      }
      write_found(found, outputs, totals);
      // Of several cameras the list leaves out guesses, which say as well that nothing need be turned.
      const bool somebody = cameras || std::ranges::any_of(found.people.people, is_found);
      if (!arguments.outputs.quiet) tell(hint.add(*found.frame, somebody));
    } catch (const BrokenPipe&) {
      throw;
    } catch (const Error& e) {
      const bool is_lost = source.is_live() && !found.frame;  // asked again, a camera says the same every few seconds
      if (!arguments.keep_going || is_lost) throw;
      progress.clear();
      say(std::string("vesalius: ") + e.what());
      ++totals.failed;
    }
    if (const auto lost = outputs.losses(); lost.size() > lossy) {
      late.add(lost.back() + "; it is tried on");
      lossy = lost.size();
    }
    progress.step();
    return arguments.frames == 0 || progress.done() < arguments.frames;
  };
  if (totals.follows) {
    PeopleTracker tracker = make_tracker(detector, arguments.detector.options());
    totals.dropped = stream_frames(source, detector, tracker, options, take);
  } else {
    totals.dropped = stream_frames(source, detector, options, take);
  }
  tell(hint.finish());
  late.print(progress);
  totals.dropped += source.missed();
  progress.clear();
  // Whoever watches a camera ends it so.
  if (interrupted() && !source.is_live()) throw Error("interrupted after " + counted(progress.done(), "frame"));
  if (totals.failed > 0) throw Error(fmt::format("{} of {} failed", totals.failed, counted(progress.done(), "frame")));
}

void say_totals(const DetectArguments& arguments, const Totals& totals, const Progress& progress) {
  std::string in_all =
      totals.follows ? fmt::format("{} followed", totals.ids.size()) : fmt::format("{} in all", totals.people);
  if (!arguments.track && !totals.follows && progress.done() > 1) in_all += "; --track follows them";
  say(fmt::format("{} frame{}, people in {} of them ({}), {:.1f} s, {:.1f} frames/s{}", progress.done(),
                  progress.done() == 1 ? "" : "s", totals.frames_with_people, in_all, progress.seconds(),
                  progress.done() / progress.seconds(),
                  arguments.stream.realtime || totals.dropped > 0 ? fmt::format(", {} dropped", totals.dropped) : ""));
}

void say_times(const FrameTimes& times) {
  std::istringstream lines(table(times));
  for (std::string line; std::getline(lines, line);) say(line);
}

void run_detect(const DetectArguments& arguments) {
  check(arguments.outputs);
  arguments.merge.check(arguments.track.value_or(true));
  keep_freed_memory();
  const ThreadLimit limit(arguments.threads);
  const Detector detector = arguments.detector.make();
  std::optional<MergedCameras> cameras;
  if (arguments.merge.asked()) {
    cameras.emplace(
        arguments.merge.make(arguments.source, detector, arguments.detector.options(), arguments.outputs.quiet));
  }
  LateLines late;
  const auto source =
      arguments.source.open(arguments.outputs.quiet, [&late](const std::string& line) { late.add(line); });
  watch_interrupts();
  DetectOutputs outputs(arguments.outputs, detector.body());
  const int all = source->size();
  const int wanted = arguments.frames == 0 || (all >= 0 && all < arguments.frames) ? all : arguments.frames;
  Progress progress(wanted, !arguments.outputs.quiet);
  Totals totals;
  totals.follows = arguments.merge.asked() || arguments.track.value_or(source->is_sequence());
  const auto say_end = [&] {
    for (const std::string& line : outputs.losses()) say("vesalius: " + line);
    if (!arguments.outputs.quiet) say_totals(arguments, totals, progress);
    if (arguments.timing) say_times(totals.times);
  };
  try {
    detect_all(arguments, *source, detector, std::move(cameras), outputs, late, progress, totals);
  } catch (const BrokenPipe&) {
    throw;
  } catch (const Error& e) {
    progress.clear();
    try {
      outputs.finish(e.what());  // the finished frames are kept
    } catch (const Error&) {     // the first error is the one to report
    }
    if (progress.done() > 0) say_end();
    throw;
  }
  outputs.finish("");
  say_end();
}

void add_output_flags(CLI::App& command, OutputRequest& outputs) {
  constexpr const char* kOutputGroup = "Output (without any of these: a line per frame)";
  const auto add = [&](const char* name, auto& value, const char* type, const char* help) {
    return command.add_option(name, value, help)->type_name(type)->group(kOutputGroup);
  };
  add("--json", outputs.json, "FILE", "People as JSON, one line a frame; - is standard output");
  add("--udp", outputs.udp, "HOST:PORT",
      "Send each frame's JSON there as datagrams, of more than 64 kB one for each person");
  add("--osc", outputs.osc, "HOST:PORT", "Send people there as OSC messages, for TouchDesigner, Max and others");
  add("--joints", outputs.json_options.joints, "SET",
      "Joint set of JSON and OSC: nite15, k4abt32 or coco17 (default: all in JSON, k4abt32 in OSC)");
  command
      .add_flag("--brief", outputs.json_options.brief,
                "JSON without body parts, fitted bodies, smoothed joints and pixels")
      ->group(kOutputGroup);
  add_places_flag(command, "--osc-frame", outputs.osc_options.on_floor, "Whose places OSC has")->group(kOutputGroup);
  add("--out", outputs.folder, "DIR", "Folder for pictures, created if missing");
  add("--save", outputs.save, "WHAT",
      "What to put into --out, separated by commas: overlay (default) and parts, pictures of skeletons and of body "
      "parts; labels (part of each pixel) and mask (person of each pixel) as numbers; cloud (labelled PLY); "
      "colour (on the grid of depth, or depth where there is none); video")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(kSaveKinds));
  add("--video-rate", outputs.video_rate, "N", "Frames per second of the video")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
}

void add_time_flags(CLI::App& command, DetectArguments& arguments) {
  const std::string group = "Time";
  command.add_flag("--timing", arguments.timing, "Print at the end how long each stage took")->group(group);
  command
      .add_flag("--realtime", arguments.stream.realtime,
                "Process frames at the pace of the camera; drop and count those that come too fast")
      ->group(group);
  add_rate_flag(command, arguments.stream.rate, "Frames per second with --realtime if the source has no times")
      ->group(group);
}

}  // namespace

void add_detect(CLI::App& program) {
  CLI::App* command = program.add_subcommand("detect", "Find people in frames");
  const auto arguments = std::make_shared<DetectArguments>(*command);
  add_output_flags(*command, arguments->outputs);
  arguments->source.add_to(*command);
  arguments->merge.add_to(*command);
  add_threads_flag(*command, arguments->threads);
  add_time_flags(*command, *arguments);
  add_track_flag(*command, arguments->track);
  add_frames_flag(*command, arguments->frames);
  command->add_flag("--keep-going", arguments->keep_going, "Skip frames that fail; the exit code is then 1");
  command->add_flag("-q,--quiet", arguments->outputs.quiet, "Print errors only");
  command->footer(R"(
Every option of detector, tracking and fitted bodies is a flag too, e.g. --search.min-parts 6; `vesalius options`
lists them.

Examples:
  vesalius detect frames/
  vesalius detect tum:walking -m small.forest --json - | jq .people
  vesalius detect session.mcap --json people.jsonl
  vesalius detect left.mcap right.mcap --merge --extrinsics cameras.json --json people.jsonl
  vesalius detect depth.png --fx 525 --out found/ --save overlay,mask)");
  command->callback([arguments] { run_detect(*arguments); });
}

}  // namespace vesalius::cli
