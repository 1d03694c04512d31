#include "console/source_flags.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "console/detector_flags.h"
#include "console/text_sink.h"

namespace vesalius::cli {
namespace {

std::unique_ptr<FrameSource> open_noted(const std::string& name, const SourceOptions& options, bool quiet) {
  auto source = open_source(name, options);
  if (!quiet) {
    for (const std::string& note : source->notes()) say("note: " + note);
  }
  return source;
}

}  // namespace

void add_camera_flags(CLI::App& command, SourceOptions& options) {
  const auto add = [&](const char* name, auto& value, const char* type, const char* help) {
    return command.add_option(name, value, help)->type_name(type)->group("Camera, where the files do not say");
  };
  add("--fx", options.fx, "PX", "Focal length, horizontal");
  add("--fy", options.fy, "PX", "Focal length, vertical (default: fx)");
  add("--cx", options.cx, "PX", "Principal point, column (default: centre)");
  add("--cy", options.cy, "PX", "Principal point, row (default: centre)");
  add("--depth-scale", options.depth_scale, "N",
      "Stored depth units per metre: 1000 = millimetres, 5000 = TUM; floats: 1");
  static const std::map<std::string, DepthBits> kinds{
      {"plain", DepthBits::plain}, {"swapped", DepthBits::swapped}, {"rotated", DepthBits::rotated}};
  command
      .add_option_function<std::string>(
          "--depth-bits", [&options](const std::string& kind) { options.depth_bits = kinds.at(kind); },
          "How 16 bits of depth are stored: plain, swapped (bytes) or rotated (three bits to the left, as in SUN "
          "RGB-D)")
      ->type_name("KIND")
      ->check(CLI::IsMember(kinds))
      ->group("Camera, where the files do not say");
  add("--camera", options.camera_file, "FILE",
      "Calibration (meta.json, camera_info of ROS, OpenCV, ...), whose distortion is undone");
  add("--colour,--color", options.colour_file, "FILE", "Colour picture of a single depth PNG");
  add("--depth-topic", options.depth_topic, "TOPIC", "Topic or stream of a recording that depth comes from");
  add("--colour-topic,--color-topic", options.colour_topic, "TOPIC",
      "Topic or stream of a recording with colour registered to depth");
}

void add_turn_flag(CLI::App& command, SourceOptions& options) {
  command
      .add_option(
          "--turn", options.turn,
          "Degrees clockwise that make the pictures upright: 90, 180 or 270 where the camera lies on its side or "
          "hangs; 0 as they are (default: as gravity tells, where the camera measures it). Results stay in the "
          "camera's own pictures and axes")
      ->type_name("DEGREES")
      ->check(CLI::IsMember({0, 90, 180, 270}));
}

void add_start_flag(CLI::App& command, SourceOptions& options) {
  command.add_option("--start", options.start_s, "Begin so many seconds after the first frame; not with a camera")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, 1e9));
}

void SourceFlags::add_to(CLI::App& command, bool required) {
  command.add_option("SOURCE", name_, kSourceHelp)->required(required);
  add_camera_flags(command, options_);
  add_turn_flag(command, options_);
  add_start_flag(command, options_);
  command
      .add_flag("--reconnect", options_.reconnect,
                "Wait for a camera that is unplugged or gives nothing, and go on when it is back")
      ->group("Camera that is plugged in");
}

std::unique_ptr<FrameSource> SourceFlags::open(bool quiet, std::function<void(const std::string&)> say) const {
  SourceOptions options = options_;
  options.say = std::move(say);
  return open_noted(name_, options, quiet);
}

std::unique_ptr<FrameSource> SourceFlags::open_other(const std::string& name, bool quiet) const {
  SourceOptions options = options_;
  options.start_s.reset();
  return open_noted(name, options, quiet);
}

void add_frames_flag(CLI::App& command, int& frames) {
  command.add_option("--frames", frames, "End after so many frames; 0 = all")
      ->type_name("N")
      ->check(CLI::Range(0, 1'000'000'000));
}

CLI::Option* add_rate_flag(CLI::App& command, double& rate, const std::string& what) {
  return command.add_option("--rate", rate, what)
      ->type_name("N")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
}

void add_track_flag(CLI::App& command, std::optional<bool>& track) {
  command.add_flag_function(
      "--track,!--no-track", [&track](std::int64_t times) { track = times > 0; },
      "Follow people over the frames: ids, states, velocities, fitted bodies; or look at each frame by itself. "
      "Recordings, cameras and other frames with times are followed unless told otherwise");
}

void add_threads_flag(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads to use; 0 = all. The result is the same")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads))
      ->group(kDetectorGroup);
}

CLI::Option* add_places_flag(CLI::App& command, const std::string& name, bool& on_floor, const std::string& whose) {
  return command
      .add_option_function<std::string>(
          name, [&on_floor](const std::string& frame) { on_floor = frame == "floor"; },
          whose +
              ": floor, where the people were followed and it is known (level, the origin on it below the camera), or "
              "camera")
      ->check(CLI::IsMember({"floor", "camera"}))
      ->default_str("floor");
}

}  // namespace vesalius::cli
