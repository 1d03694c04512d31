#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "cli/ros2/ros2_flags.h"
#include "console/detector_flags.h"
#include "console/interrupts.h"
#include "console/source_flags.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "io/files/plain_text.h"
#include "io/sensors/live_source.h"
#include "io/sources/source_around.h"
#include "ros2/dds/node_sink.h"
#include "ros2/messages/message_sink.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/detect_stream.h"
#include "vesalius/parallel.h"
#include "vesalius/person_json.h"

namespace vesalius::cli {
namespace {

constexpr const char* kUsualFrame = "camera_optical_frame";

struct Ros2Arguments {
  explicit Ros2Arguments(CLI::App& command) : detector(command) {}

  SourceFlags source;
  DetectorFlags detector;
  std::string record;
  Ros2Flags ros2;
  double rate = kUsualRate;
  int threads = 0;
  int frames = 0;  ///< 0 = all
  bool every_frame = false;
  bool quiet = false;
};

/// Tells when and where frames were taken.
class Stamps {
 public:
  Stamps(const Ros2Arguments& arguments, bool is_live, const ros2::TopicSource* topics)
      : arguments_(arguments), is_live_(is_live), topics_(topics) {}

  ros2::Stamp of(const Frame& frame) {
    ros2::Stamp stamp = topics_ != nullptr ? topics_->stamp_of(frame) : ros2::Stamp{time_ns(frame), kUsualFrame};
    if (!arguments_.ros2.frame_id.empty()) stamp.frame = arguments_.ros2.frame_id;
    ++frames_;
    return stamp;
  }

 private:
  static std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

  std::int64_t time_ns(const Frame& frame) {
    const std::string& wanted = arguments_.ros2.stamps;
    // A camera's clock may count from anything; ROS 2 counts from 1970.
    if (is_live_ && wanted != "frame") return nanoseconds(frame.arrived_s.value_or(now_s()));
    const double own_s = frame.time_s.value_or(frames_ / arguments_.rate);
    // Others put what they get beside transforms of now; who goes through a file frame by frame wants the same each
    // time.
    if (wanted == "frame" || (wanted.empty() && arguments_.every_frame)) return nanoseconds(own_s);
    if (!later_s_) later_s_ = now_s() - own_s;
    return nanoseconds(own_s + *later_s_);
  }

  const Ros2Arguments& arguments_;
  bool is_live_;
  const ros2::TopicSource* topics_;  ///< null where frames come from a source
  int frames_ = 0;
  std::optional<double> later_s_;  ///< what times of frames become those of this machine by
};

/// Throws UsageError for flags that do not go together, or say what cannot be meant.
void check(const Ros2Arguments& arguments) {
  const Ros2Flags& flags = arguments.ros2;
  if (arguments.source.name().empty() == flags.subscribe.empty()) {
    throw UsageError("expected either SOURCE or --subscribe NAMESPACE (see vesalius ros2 --help)");
  }
  if (!flags.subscribe.empty()) {
    if (arguments.source.options().start_s) throw UsageError("--start goes with a SOURCE only");
    if (!flags.stamps.empty()) throw UsageError("--stamps: subscribed pictures have times of their own");
    if (arguments.every_frame) throw UsageError("--every-frame goes with a SOURCE only");
    subscribe_options(flags, arguments.source.options());
  } else {
    if (!flags.camera_info_topic.empty()) throw UsageError("--camera-info-topic goes with --subscribe only");
    if (flags.reliable) throw UsageError("--reliable goes with --subscribe only");
  }
  ros2::check(topic_options(flags));
  parse_camera_pose(flags.camera_pose);
}

/// Follows people in a source and writes their messages. Returns how many frames were dropped.
int publish(const Ros2Arguments& arguments, FrameSource& source, const Detector& detector, Stamps& stamps,
            ros2::MessageSink& sink, LateLines& late, Progress& progress) {
  const BodyModel& body = detector.body();
  ros2::PeopleTopics topics(body, topic_options(arguments.ros2), sink);
  const std::optional<CameraPose> pose = parse_camera_pose(arguments.ros2.camera_pose);
  PeopleTracker tracker = make_tracker(detector, arguments.detector.options());
  StreamOptions options;
  options.realtime = !arguments.every_frame;
  options.rate = arguments.rate;
  options.stop = [&] {
    late.print(progress);
    return interrupted();
  };
  ros2::Stamp last;
  const int dropped = stream_frames(source, detector, tracker, options, [&](const FoundFrame& found) {
    if (found.error) std::rethrow_exception(found.error);
    last = stamps.of(*found.frame);
    if (pose && progress.done() == 0) topics.write_camera_pose(pose->parent, pose->parent_from_optical, last);
    const auto json = [&] { return frame_json(*found.frame, found.people, body, found.latency_ms); };
    topics.write(*found.frame, found.people, json, last);
    progress.step();
    return arguments.frames == 0 || progress.done() < arguments.frames;
  });
  if (progress.done() > 0) topics.clear(last);
  return dropped;
}

/// Returns the frames; `topics` receives their source if they come from topics.
std::unique_ptr<FrameSource> open_frames(const Ros2Arguments& arguments, ros2::Node& node, LateLines& late,
                                         const ros2::TopicSource*& topics) {
  const auto say_late = [&late](const std::string& line) { late.add(line); };
  if (arguments.ros2.subscribe.empty()) return arguments.source.open(arguments.quiet, say_late);
  ros2::TopicSourceOptions wanted = subscribe_options(arguments.ros2, arguments.source.options());
  wanted.say = say_late;
  auto source = std::make_unique<ros2::TopicSource>(node, wanted);
  topics = source.get();
  if (const auto turn = arguments.source.options().turn)
    return std::make_unique<TurnedSource>(std::move(source), *turn);
  return source;
}

void run_ros2(const Ros2Arguments& arguments) {
  check(arguments);
  LateLines late;
  ros2::NodeOptions node_settings = node_options(arguments.ros2);
  node_settings.say = [&late](const std::string& line) { late.add(line); };
  ros2::Node node(node_settings);
  keep_freed_memory();
  const ThreadLimit limit(arguments.threads);
  const Detector detector = arguments.detector.make();
  const ros2::TopicSource* topics = nullptr;
  const auto source = open_frames(arguments, node, late, topics);
  ros2::NodeSink network(node);
  std::optional<ros2::RecordSink> recorder;
  if (!arguments.record.empty()) recorder.emplace(arguments.record, network);
  watch_interrupts();
  Progress progress(arguments.frames > 0 ? arguments.frames : source->size(), !arguments.quiet);
  Stamps stamps(arguments, source->is_live(), topics);
  int missed = 0;
  try {
    ros2::MessageSink& sink = recorder ? static_cast<ros2::MessageSink&>(*recorder) : network;
    missed = publish(arguments, *source, detector, stamps, sink, late, progress);
  } catch (const Error&) {
    progress.clear();
    late.print(progress);
    if (recorder) recorder->close();  // what was recorded is kept
    throw;
  }
  if (recorder) recorder->close();
  network.wait_until_read(std::chrono::milliseconds(1000));
  progress.clear();
  late.print(progress);
  missed += source->missed();
  if (interrupted() && !source->is_live()) throw Error("interrupted after " + counted(progress.done(), "frame"));
  if (!arguments.quiet) {
    say(fmt::format("{}{}", counted(progress.done(), "frame"), missed > 0 ? fmt::format(", {} dropped", missed) : ""));
  }
}

}  // namespace

void add_ros2(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("ros2", "Publish the people in a source, or in topics, as a node of ROS 2");
  const auto arguments = std::make_shared<Ros2Arguments>(*command);
  add_ros2_flags(*command, arguments->ros2);
  command->add_option("--record", arguments->record, "Write the same messages to an MCAP file too; must not exist")
      ->type_name("FILE");
  add_frames_flag(*command, arguments->frames);
  command->add_flag("--every-frame", arguments->every_frame,
                    "Take all frames of a file one after the other, not at the pace at which they were taken");
  add_rate_flag(*command, arguments->rate, "Frames per second of a source without times");
  add_threads_flag(*command, arguments->threads);
  arguments->source.add_to(*command, false);
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  command->footer(R"(
People are followed over the frames, so that names of bodies hold. docs/ros2.md has the topics. No installation of
ROS 2 is needed. Every option of detector and tracking is a flag too; `vesalius options` lists them.

Examples:
  vesalius ros2 frames/
  vesalius ros2 session.mcap --frame-id camera_depth_optical_frame --record people.mcap
  vesalius ros2 --subscribe /camera --namespace /robot
  vesalius ros2 realsense: --camera-pose base_link,0.1,0,1.2,0,0.2,0)");
  command->callback([arguments] { run_ros2(*arguments); });
}

}  // namespace vesalius::cli
