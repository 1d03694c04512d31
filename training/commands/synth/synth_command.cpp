#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

#include "commands/cluster/cluster_flags.h"
#include "commands/synth/contact_sheet.h"
#include "commands/synth/frame_maker.h"
#include "commands/synth/imitate_sensor.h"
#include "commands/synth/render_cluster.h"
#include "console/interrupts.h"
#include "console/option_flags.h"
#include "console/satellites.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "dataset/labelled_folder.h"
#include "io/files/data_file.h"
#include "io/files/options_file.h"
#include "io/files/plain_text.h"
#include "synth/body/poser.h"
#include "synth/sensor/embree_scene.h"
#include "train/parallel_in_order.h"
#include "vesalius/image_file.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

constexpr int kMaxFrames = 1'000'000'000;
constexpr int kMaxPreview = 200;
constexpr int kPreviewColumns = 3;

struct Arguments {
  explicit Arguments(CLI::App& command) : recipe_flags(command) {}

  std::string recipe, sensor, camera, body, assets, motions, like, out, format = "shards";
  OptionFlags<synth::Recipe> recipe_flags;
  ClipRequest clip;
  ClusterFlags cluster;
  int count = 0, preview = 0, first = 0, shard = 256, threads = 0;
  int cameras = 0;  ///< folders of the same clips, each seen by another camera; 0 = one folder of its own
  std::uint64_t seed = 1;
  bool quiet = false;
};

BodyModel body_of(const Arguments& arguments) {
  return arguments.body.empty() ? paper_body() : parse_body_model(read_file(arguments.body), arguments.body);
}

LabelledFrame as_it_is(std::uint64_t /*index*/, LabelledFrame frame) { return frame; }

void write_folder(const Arguments& arguments, const std::string& folder, const FrameMaker& maker,
                  const BodyModel& body) {
  LabelledExporter exporter(folder, body, synth::joint_names(), maker.clips);
  const auto count = int(maker.frames_in(arguments.count));
  Progress progress(count, !arguments.quiet);
  make_frames(maker, maker.frames_in(arguments.first), count, progress, as_it_is,
              [&](std::uint64_t /*index*/, const LabelledFrame& frame) { exporter.write(frame); });
  exporter.close();
  progress.clear();
  if (!arguments.quiet) say(folder + ": " + counted(progress.done(), "frame"));
}

/// Writes the same clips as each camera sees them, into camera_0 and so on.
void write_cameras(const Arguments& arguments, synth::Recipe recipe, const LoadedAssets& loaded,
                   const BodyModel& body) {
  recipe.clip.cameras = arguments.cameras;
  for (int i = 0; i < arguments.cameras; ++i) {
    recipe.clip.seen_from = i;
    const FrameMaker maker = make_frame_maker(recipe, loaded.assets, body, arguments.seed, arguments.clip);
    write_folder(arguments, fmt::format("{}/camera_{}", arguments.out, i), maker, body);
  }
}

/// Returns the numbers of a preview's frames: those from `first` on, or frames spread evenly over that clip.
std::vector<std::uint64_t> preview_frames(const Arguments& arguments, const FrameMaker& maker) {
  const std::uint64_t first = maker.frames_in(arguments.first), per_clip = maker.clips.frames_per_clip;
  std::vector<std::uint64_t> numbers;
  for (int i = 0; i < arguments.preview; ++i) {
    const auto step = static_cast<std::uint64_t>(i);
    if (per_clip == 0) numbers.push_back(first + step);
    if (per_clip > step)
      numbers.push_back(first + step * per_clip / std::min<std::uint64_t>(per_clip, arguments.preview));
  }
  return numbers;
}

void write_preview(const Arguments& arguments, const FrameMaker& maker, const BodyModel& body) {
  const std::vector<std::uint64_t> numbers = preview_frames(arguments, maker);
  const FrameMaker shown{[&](std::uint64_t i) { return maker.frame(numbers[i]); }, {}};
  std::vector<LabelledFrame> frames;
  Progress progress(int(numbers.size()), !arguments.quiet);
  make_frames(shown, 0, int(numbers.size()), progress, as_it_is,
              [&](std::uint64_t /*index*/, LabelledFrame frame) { frames.push_back(std::move(frame)); });
  progress.clear();
  const std::string path = arguments.out.empty() ? "preview.png" : arguments.out;
  write_png(contact_sheet(frames, body, kPreviewColumns), path);
  if (!arguments.quiet) say(path + ": " + counted(std::ssize(frames), "frame"));
}

/// Proposes the options of a sensor whose pictures are like those of a source, on standard output or in a file.
void propose_sensor(const Arguments& arguments, synth::Recipe recipe) {
  constexpr int kMostFrames = 100, kUsualRooms = 40, kBodies = 6;
  const int rooms = arguments.count > 0 ? arguments.count : kUsualRooms;
  TextSink sink(arguments.out.empty() ? "-" : arguments.out);  // before work that it would lose
  const MeasuredCamera real = measure_source(arguments.like, kMostFrames);
  if (!arguments.quiet) {
    for (const std::string& note : real.notes) say("note: " + note);
  }
  recipe.body.kind = "builtin";  // what people look like hardly matters here
  recipe.body.count = kBodies;
  recipe.pose.captured = 0.F;
  const Imitation imitation = imitate(real, arguments.sensor, recipe, rooms, arguments.seed, !arguments.quiet);
  sink.line(imitation_toml(arguments.like, real, imitation));
  sink.finish();
  if (!arguments.out.empty() && !arguments.quiet) say(arguments.out + ": a sensor, for --recipe");
}

void check(const Arguments& arguments) {
  const bool makes = arguments.like.empty();
  if (arguments.preview > 0 ? arguments.count > 0 || !makes : makes && arguments.count == 0) {
    throw UsageError("expected one of --count, --preview and --like");
  }
  const ClipRequest& clip = arguments.clip;
  if (!makes) {
    if (!clip.clip_s && !clip.rate_hz && arguments.cameras == 0 && arguments.first == 0 && arguments.cluster.on.empty())
      return;
    throw UsageError("--like expects none of --clip, --rate, --cameras, --first and --on");
  }
  if (arguments.count > 0 && arguments.out.empty()) throw UsageError("--count expects --out, the folder to write");
  if (arguments.first > 0 && arguments.count > 0 && arguments.format == "shards") {
    throw UsageError("a dataset begins with frame 0: --first expects --preview or --format folder");
  }
  if (!arguments.cluster.on.empty() && (arguments.count == 0 || arguments.format != "shards")) {
    throw UsageError("--on expects --count with --format shards");
  }
  if (arguments.cameras > 0 && (arguments.count == 0 || arguments.format != "folder" || !clip.clip_s)) {
    throw UsageError("--cameras expects --clip, and --count with --format folder");
  }
  if (clip.rate_hz && !clip.clip_s) throw UsageError("--rate expects --clip, the seconds of each clip");
  if (!clip.clip_s) return;
  const auto clips = static_cast<std::int64_t>(arguments.first) + std::max(1, arguments.count);
  if (clips * timing_of(clip).frames() > kMaxFrames) {
    throw UsageError(fmt::format("{} clips of {} frames, expected at most {} frames in all", clips,
                                 timing_of(clip).frames(), kMaxFrames));
  }
}

void run(const Arguments& arguments) {
  check(arguments);
  const ThreadLimit limit(arguments.threads);
  const synth::Recipe recipe =
      make_recipe({.file = arguments.recipe,
                   .sensor = arguments.sensor,
                   .camera = arguments.camera,
                   .change = [&](synth::Recipe& asked) { arguments.recipe_flags.apply(asked); }});
  if (!arguments.like.empty()) {
    watch_interrupts();
    return propose_sensor(arguments, recipe);
  }
  const BodyModel body = body_of(arguments);
  const LoadedAssets loaded = load_assets(
      recipe,
      {.folder = arguments.assets, .motions = arguments.motions, .movements = arguments.clip.clip_s.has_value()});
  if (!arguments.quiet) {
    for (const std::string& note : loaded.notes) say("note: " + note);
    say(pose_counts(recipe.pose, loaded.assets));
  }
  watch_interrupts();
  if (arguments.cameras > 0) return write_cameras(arguments, recipe, loaded, body);
  const FrameMaker maker = make_frame_maker(recipe, loaded.assets, body, arguments.seed, arguments.clip);
  if (arguments.preview > 0) return write_preview(arguments, maker, body);
  if (arguments.format == "folder") return write_folder(arguments, arguments.out, maker, body);
  DatasetInfo info = rendered_info(recipe, loaded, body, arguments.seed, maker.frames_in(arguments.count));
  info.clips = maker.clips;
  info.frames_per_shard = arguments.shard;
  if (!arguments.cluster.on.empty()) {
    const RenderRequest request{recipe, body, {arguments.assets, arguments.motions, false}, arguments.clip};
    return render_on_cluster(request, info, arguments.out, arguments.cluster, !arguments.quiet);
  }
  write_dataset(arguments.out, maker, info, !arguments.quiet);
}

void add_output_flags(CLI::App& command, Arguments& arguments) {
  const std::string group = "Output";
  command
      .add_option("--count", arguments.count,
                  "Frames to make; with --clip clips; with --like rooms rendered for each trial (default: 40)")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxFrames))
      ->group(group);
  command
      .add_option("--preview", arguments.preview,
                  "Instead of a dataset, a picture of this many frames; with --clip spread over the first clip")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxPreview))
      ->group(group);
  command
      .add_option(
          "--like", arguments.like,
          "Instead of a dataset, a recipe of the sensor whose pictures are most like those of this recording, "
          "folder or camera, with the figures of both; labels are not needed. --preset says which camera it is, if "
          "you know")
      ->type_name("SOURCE")
      ->group(group);
  command
      .add_option("--out", arguments.out,
                  "Folder for the frames, created if missing; an interrupted run continues. With --preview the "
                  "picture (default: preview.png), with --like the recipe (default: printed)")
      ->type_name("PATH")
      ->group(group);
  command.add_option("--format", arguments.format, "shards: compact, for training; folder: PNG and JSON")
      ->check(CLI::IsMember({"shards", "folder"}))
      ->capture_default_str()
      ->group(group);
  command.add_option("--seed", arguments.seed, "A frame depends only on the recipe, this seed and its number")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--clip", arguments.clip.clip_s,
                  "Clips of so many seconds instead of single frames: people who move before a camera")
      ->type_name("SECONDS")
      ->group(group);
  command
      .add_option("--rate", arguments.clip.rate_hz,
                  fmt::format("Frames a second of clips (default: {})", synth::ClipTiming{}.rate_hz))
      ->type_name("HZ")
      ->group(group);
  command
      .add_option("--cameras", arguments.cameras,
                  "With --clip and --format folder: folders camera_0, ... of the same clips, each seen by another "
                  "camera, which stand; --clip.apart says how far apart")
      ->type_name("N")
      ->check(CLI::Range(1, synth::kMostClipCameras))
      ->group(group);
  command
      .add_option("--first", arguments.first, "Number of the first frame, or clip, for --preview and --format folder")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxFrames))
      ->group(group);
  command.add_option("--shard", arguments.shard, "Frames in a shard")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str()
      ->group(group);
}

void add_recipe_flags(CLI::App& command, Arguments& arguments) {
  const std::string group = "What to make";
  std::vector<std::string> names;
  for (const synth::Sensor& sensor : synth::sensors()) names.push_back(sensor.name);
  command
      .add_option("--preset", arguments.sensor,
                  fmt::format("Depth camera: {} (default: {})", fmt::join(names, ", "), synth::SensorOptions{}.preset))
      ->type_name("NAME")
      ->group(group);
  command.add_option("--camera", arguments.camera, "Other intrinsics for the camera: meta.json or camera_info YAML")
      ->type_name("FILE")
      ->group(group);
  command.get_option("--mounting")->type_name("NAME")->group(group);
  command.add_option("--recipe", arguments.recipe, "TOML file of options; `vesalius options synth` prints one")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--body", arguments.body, "Body model with other parts")->type_name("FILE")->group(group);
  command.add_option("--motions", arguments.motions, "Motions of your own: a folder of .bvh, or .amc with .asf")
      ->type_name("DIR")
      ->group(group);
  command.add_option("--assets", arguments.assets, "Folder in which `vesalius assets` put its files")
      ->type_name("DIR")
      ->group(group);
}

void add_synth(CLI::App& program) {
  CLI::App* command = program.add_subcommand("synth", "Make labelled frames of synthetic people");
  const auto arguments = std::make_shared<Arguments>(*command);
  add_output_flags(*command, *arguments);
  add_recipe_flags(*command, *arguments);
  command->add_option("--threads", arguments->threads, "Threads to use; 0 = all. The result is the same")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads));
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  add_cluster_flags(*command, arguments->cluster);
  add_render_task(*command);
  command->footer(R"(
Every option of a recipe is a flag too, e.g. --people.two 1; `vesalius options synth` lists them.

Examples:
  vesalius synth --preview 24 --out look.png
  vesalius synth --preset kinect-v1 --count 10000 --seed 1 --out train/
  vesalius synth --clip 5 --preview 9 --out clip.png
  vesalius synth --like my_recording/ --preset d435 --out like.toml
  vesalius synth --preset d435 --mounting ceiling --recipe mine.toml --count 500 --out ceiling/)");
  command->callback([arguments, command] {
    if (command->get_subcommands().empty()) run(*arguments);
  });
}

}  // namespace

Satellite synth_satellite() {
  return {.name = "synth",
          .commands = {add_synth},
          .default_options =
              [] {
                synth::Recipe recipe;
                return options_toml([&](OptionVisitor& visitor) { visit_options("", recipe, visitor); });
              },
          .facts =
              [] {
                return std::vector<std::pair<std::string, std::string>>{{"renderer", synth::embree_version()}};
              }};
}

}  // namespace vesalius::cli
