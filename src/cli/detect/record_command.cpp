#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "console/detector_flags.h"
#include "console/interrupts.h"
#include "console/source_flags.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "io/files/plain_text.h"
#include "io/recordings/frame_recorder.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/detect_stream.h"
#include "vesalius/person_json.h"

namespace vesalius::cli {
namespace {

struct RecordArguments {
  explicit RecordArguments(CLI::App& command) : detector(command) {}

  SourceFlags source;
  DetectorFlags detector;
  std::string out;
  double rate = kUsualRate;
  int frames = 0;  ///< 0 = all
  bool people = false;
  std::optional<bool> track;  ///< true implies people
  bool quiet = false;
};

/// Returns whether all frames that are wanted were recorded.
bool is_enough(const RecordArguments& arguments, const Progress& progress) {
  return arguments.frames > 0 && progress.done() >= arguments.frames;
}

/// Returns the number of frames that were dropped.
int record_frames(const RecordArguments& arguments, FrameSource& source, FrameRecorder& recorder,
                  const StreamOptions& options, Progress& progress) {
  constexpr std::size_t kAhead = 30;  // a second: discs pause for less, and 640x480 takes 46 MB
  return stream_frames(source, options, kAhead, [&](const FoundFrame& found) {
    if (found.error) std::rethrow_exception(found.error);
    recorder.write(*found.frame);
    progress.step();
    return !is_enough(arguments, progress);
  });
}

/// Returns the number of frames that were dropped.
int record_people(const RecordArguments& arguments, FrameSource& source, const Detector& detector,
                  FrameRecorder& recorder, const StreamOptions& options, Progress& progress) {
  const BodyModel& body = detector.body();
  const auto take = [&](const FoundFrame& found) {
    if (found.error) std::rethrow_exception(found.error);
    recorder.write(*found.frame);
    recorder.write_people(*found.frame, found.people, body,
                          frame_json(*found.frame, found.people, body, found.latency_ms));
    progress.step();
    return !is_enough(arguments, progress);
  };
  if (!arguments.track.value_or(true)) return stream_frames(source, detector, options, take);
  PeopleTracker tracker = make_tracker(detector, arguments.detector.options());
  return stream_frames(source, detector, tracker, options, take);
}

void run_record(const RecordArguments& arguments) {
  keep_freed_memory();
  std::optional<Detector> detector;
  if (arguments.people || arguments.track.value_or(false)) detector.emplace(arguments.detector.make());
  LateLines late;
  const auto source = arguments.source.open(arguments.quiet, [&late](const std::string& line) { late.add(line); });
  FrameRecorder recorder(arguments.out, arguments.rate);
  watch_interrupts();
  Progress progress(arguments.frames > 0 ? arguments.frames : source->size(), !arguments.quiet);
  StreamOptions options;
  options.stop = [&] {
    late.print(progress);
    return interrupted();
  };
  int missed = 0;
  try {
    missed = detector ? record_people(arguments, *source, *detector, recorder, options, progress)
                      : record_frames(arguments, *source, recorder, options, progress);
  } catch (const Error& e) {
    progress.clear();
    recorder.close();  // what was recorded is kept
    const std::string text = fmt::format("{}; {} has the {} frames before", e.what(), arguments.out, progress.done());
    if (dynamic_cast<const UsageError*>(&e) != nullptr) throw UsageError(text);
    throw Error(text);
  }
  recorder.close();
  progress.clear();
  late.print(progress);
  missed += source->missed();
  if (interrupted() && !source->is_live()) {
    throw Error(fmt::format("interrupted; the {} frames before it are in {}", progress.done(), arguments.out));
  }
  if (!arguments.quiet) {
    say(fmt::format("{}: {}{}", arguments.out, counted(progress.done(), "frame"),
                    missed > 0 ? fmt::format(", {} missed", missed) : ""));
  }
}

}  // namespace

void add_record(CLI::App& program) {
  CLI::App* command = program.add_subcommand("record", "Record frames, and people if wanted, into an MCAP file");
  const auto arguments = std::make_shared<RecordArguments>(*command);
  command->add_option("--out", arguments->out, "MCAP file to write; must not exist")->type_name("FILE")->required();
  command->add_flag("--people", arguments->people, "Find people and record them too: body index, parts, markers, JSON");
  add_track_flag(*command, arguments->track);
  add_rate_flag(*command, arguments->rate, "Frames per second of a source that does not know its frames' times");
  add_frames_flag(*command, arguments->frames);
  arguments->source.add_to(*command);
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  command->footer(R"(
The file holds depth without loss and opens in Foxglove, Rerun and rosbag2 (docs/recordings.md). One whose recording was
killed lacks the last second at most.

Examples:
  vesalius record frames/ --out session.mcap
  vesalius record session.bag --out followed.mcap --people
  vesalius detect session.mcap)");
  command->callback([arguments] { run_record(*arguments); });
}

}  // namespace vesalius::cli
