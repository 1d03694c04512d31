#pragma once

#include <memory>

#include "vesalius/detect.h"

namespace vesalius::k4abt {

/// Returns the detector of a model, which all trackers of that model share. `model_path` is what a program configures:
/// null and what only Microsoft's library reads (.onnx) stand for $VESALIUS_MODEL, or else for the model that comes
/// with vesalius. Throws Error for a model that cannot be read.
std::shared_ptr<const Detector> shared_detector(const char* model_path);

}  // namespace vesalius::k4abt
