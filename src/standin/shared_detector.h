#pragma once

#include <memory>
#include <string>

#include "vesalius/detect.h"

namespace vesalius::standin {

/// Returns the detector of a model file, which all trackers of that model share. Throws Error for one that cannot be
/// read.
std::shared_ptr<const Detector> shared_detector(const std::string& model);

/// Returns the path of the usual model: $VESALIUS_MODEL, or else the one that comes with vesalius. `symbol` is one of
/// the library's own, `models_from` the way from its folder to that of the models. Throws Error if there is none.
std::string usual_model(const void* symbol, const std::string& models_from);

}  // namespace vesalius::standin
