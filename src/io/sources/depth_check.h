#pragma once

#include <functional>
#include <memory>
#include <string>

#include "vesalius/frame_source.h"
#include "vesalius/image.h"

namespace vesalius {

/// Returns whether a picture has enough depth to be looked at; some cameras begin with some that have not.
bool has_depth(const DepthImage& depth);

/// First frames of a source of which one should have depth.
inline constexpr int kFirstFrames = 5;

/// Returns why depth is none that a camera gives in a room: of another unit, with bytes swapped or bits rotated, or
/// none at all; nothing where it is, or too small a picture to tell. `reread` reads the picture with other options than
/// `given`; what it throws counts as no remedy. `place` begins the line, which names the options that give depth of a
/// room.
std::string doubt_of_depth(const DepthImage& depth, const std::string& place, const SourceOptions& given,
                           const std::function<DepthImage(const SourceOptions&)>& reread);

/// Returns the source with a note where there is a doubt of the depth of its first frames, which `open` opens again
/// with other options. The source is read up to its first frame that has depth, the fifth at most; `next` gives these
/// frames, and throws what they threw. `place` is for the note.
std::unique_ptr<FrameSource> with_depth_checked(
    std::unique_ptr<FrameSource> source, const std::string& place, const SourceOptions& options,
    const std::function<std::unique_ptr<FrameSource>(const SourceOptions&)>& open);

}  // namespace vesalius
