#include "commands/synth/write_dataset.h"

#include <vector>

#include "commands/synth/synth_recipe.h"
#include "console/text_sink.h"
#include "dataset/labelled_dataset.h"
#include "dataset/labelled_frame_codec.h"
#include "synth/skeleton_joints.h"

namespace vesalius::cli {

DatasetInfo rendered_info(const synth::Recipe& recipe, const LoadedAssets& loaded, const BodyModel& body,
                          std::uint64_t seed, std::uint64_t frames) {
  DatasetInfo info;
  info.body_toml = body.toml;
  info.recipe = full_recipe(recipe, loaded);
  info.seed = seed;
  info.frames = frames;
  info.joints = synth::joint_names();
  return info;
}

void write_dataset(const std::string& folder, const FrameMaker& maker, const DatasetInfo& info, bool shown) {
  DatasetWriter writer(folder, info);
  const std::vector<FrameRange> ranges = writer.missing();
  std::uint64_t missing = 0;
  for (const FrameRange& range : ranges) missing += range.count;
  if (missing < info.frames && shown) {
    say(fmt::format("{}: {} of {} frames are there", folder, info.frames - missing, info.frames));
  }
  Progress progress(int(missing), shown);
  const int part_count = parse_body_model(info.body_toml, folder).part_count();
  const auto encode = [&](std::uint64_t index, LabelledFrame frame) {
    return encode_frame({index, info.seed, std::move(frame)}, part_count);
  };
  for (const FrameRange& range : ranges) {
    make_frames(maker, range.first, int(range.count), progress, encode,
                [&](std::uint64_t index, std::string bytes) { writer.write_encoded(index, std::move(bytes)); });
  }
  progress.clear();
  if (shown && missing > 0) {
    say(fmt::format("{}: {} frames, {:.1f} frames/s", folder, info.frames, progress.done() / progress.seconds()));
  }
}

}  // namespace vesalius::cli
