#include "dataset/clip_layout.h"

#include <fmt/format.h>

#include "vesalius/error.h"

namespace vesalius {

void check(const ClipLayout& clips) {
  const bool alone = clips.frames_per_clip == 0 && clips.rate_hz == 0.0;
  if (alone || (clips.frames_per_clip > 0 && clips.rate_hz > 0.0 && clips.rate_hz <= kHighestRate_hz)) return;
  throw UsageError(fmt::format("clips of {} frames at {} a second, expected both 0, or a rate up to {}",
                               clips.frames_per_clip, clips.rate_hz, kHighestRate_hz));
}

}  // namespace vesalius
