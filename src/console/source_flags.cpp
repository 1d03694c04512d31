#include "console/source_flags.h"

#include <CLI/CLI.hpp>

namespace vesalius::cli {

void add_camera_flags(CLI::App& command, SourceOptions& options) {
  const std::string group = "Camera, where the files do not say";
  const auto add = [&](const char* name, std::optional<float>& value, const char* unit, const char* help) {
    return command.add_option(name, value, help)->type_name(unit)->group(group);
  };
  add("--fx", options.fx, "PX", "Focal length, horizontal");
  add("--fy", options.fy, "PX", "Focal length, vertical (default: fx)");
  add("--cx", options.cx, "PX", "Principal point, column (default: centre)");
  add("--cy", options.cy, "PX", "Principal point, row (default: centre)");
  add("--depth-scale", options.depth_scale, "N", "Stored depth units per metre: 1000 = millimetres, 5000 = TUM");
  command.add_option("--camera", options.camera_file, "meta.json or ROS camera_info YAML, whose distortion is undone")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--colour,--color", options.colour_file, "Colour picture of a single depth PNG")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--depth-topic", options.depth_topic, "Topic or stream of a recording that depth comes from")
      ->type_name("TOPIC")
      ->group(group);
  command
      .add_option("--colour-topic,--color-topic", options.colour_topic,
                  "Topic or stream of a recording with colour registered to depth")
      ->type_name("TOPIC")
      ->group(group);
}

void add_start_flag(CLI::App& command, SourceOptions& options) {
  command.add_option("--start", options.start_s, "Begin so many seconds after the first frame; not with a camera")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber);
}

void add_reconnect_flag(CLI::App& command, SourceOptions& options) {
  command
      .add_flag("--reconnect", options.reconnect,
                "Wait for a camera that is unplugged or gives nothing, and go on when it is back")
      ->group("Camera that is plugged in");
}

}  // namespace vesalius::cli
