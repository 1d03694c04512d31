#pragma once

#include "vesalius/base/frame.h"
#include "vesalius/detect.h"
#include "vesalius/forest/label_pixels.h"

namespace vesalius {

/// Labels of the first pass, smoothed, and nothing else of the method.
struct SceneLabels {
  LabelImage labels;  ///< background as a rival, where the labeller knows it
  LabelImage inside;  ///< on the pixels of `body` the best part whatever the background says; empty without `body`
};

/// For a labeller that knows the background `labels` are Trace::labels. One that does not labels every reading here: it
/// is not shown the scene without its flat surfaces, as the detector does.
SceneLabels label_scene(const PixelLabeller& labeller, const DetectOptions& options, const Frame& frame,
                        const Mask* body = nullptr);

}  // namespace vesalius
