#include "commands/synth/frame_maker.h"

#include <memory>
#include <utility>

#include "synth/clip_generator.h"
#include "synth/generate.h"

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

}  // namespace vesalius::cli
