#pragma once

#include <functional>
#include <memory>
#include <string>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Returns the source with a note where the depth of its first frames is none that a camera gives in a room: of another
/// unit, with bytes swapped or bits rotated, or none at all. Where it is not, `open` opens the source with other
/// options, and the note names those that give depth of a room. The source is read up to its first frame that has
/// depth, the fifth at most; `next` gives these frames, and throws what they threw. `place` is for the note.
std::unique_ptr<FrameSource> with_depth_checked(
    std::unique_ptr<FrameSource> source, const std::string& place, const SourceOptions& options,
    const std::function<std::unique_ptr<FrameSource>(const SourceOptions&)>& open);

}  // namespace vesalius
