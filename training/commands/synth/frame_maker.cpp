#include "commands/synth/frame_maker.h"

#include <memory>
#include <vector>

#include "console/text_sink.h"
#include "dataset/labelled_dataset.h"
#include "dataset/labelled_frame_codec.h"
#include "io/files/plain_text.h"
#include "synth/body/poser.h"

namespace vesalius::cli {

FrameMaker make_frame_maker(const synth::Recipe& recipe, synth::BodiesAndMotions assets, const BodyModel& body,
                            std::uint64_t seed, const ClipRequest& clips) {
  if (!clips.clip_s) {
    const auto generator = std::make_shared<const synth::Generator>(recipe, std::move(assets), body, seed);
    return {[generator](std::uint64_t index) { return generator->frame(index); }, {}};
  }
  const synth::ClipTiming timing = timing_of(clips);
  const auto generator = std::make_shared<const synth::ClipGenerator>(recipe, std::move(assets), body, seed, timing);
  return {[generator](std::uint64_t index) { return generator->frame(index); },
          {static_cast<std::uint32_t>(timing.frames()), timing.rate_hz}};
}

synth::ClipTiming timing_of(const ClipRequest& clips) {
  const synth::ClipTiming timing{clips.clip_s.value(), clips.rate_hz.value_or(synth::ClipTiming{}.rate_hz)};
  check(timing);
  return timing;
}

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
    say(fmt::format("{}: {} of {} are there", folder, info.frames - missing, counted(info.frames, "frame")));
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
    say(fmt::format("{}: {}, {:.1f} frames/s", folder, counted(info.frames, "frame"),
                    progress.done() / progress.seconds()));
  }
}

}  // namespace vesalius::cli
